// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "eval/mask_score.h"

#include <cassert>

namespace semantic_vslam {
namespace {

double share(std::uint64_t part, std::uint64_t rest) {
  return part + rest == 0 ? 1.0 : static_cast<double>(part) / static_cast<double>(part + rest);
}

}  // namespace

void MaskScore::add(const cv::Mat1b& estimate, const cv::Mat1b& truth) {
  assert(estimate.size() == truth.size());
  const cv::Mat1b estimated = estimate >= 128, real = truth >= 128;
  const auto both = static_cast<std::uint64_t>(cv::countNonZero(estimated & real));
  both_px_ += both;
  only_estimate_px_ += static_cast<std::uint64_t>(cv::countNonZero(estimated)) - both;
  only_truth_px_ += static_cast<std::uint64_t>(cv::countNonZero(real)) - both;
  ++frames_;
}

double MaskScore::iou() const { return share(both_px_, only_estimate_px_ + only_truth_px_); }
double MaskScore::precision() const { return share(both_px_, only_estimate_px_); }
double MaskScore::recall() const { return share(both_px_, only_truth_px_); }

}  // namespace semantic_vslam
