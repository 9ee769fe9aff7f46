// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/motion/dense_flow.h"

#include <algorithm>
#include <cmath>

namespace semantic_vslam {
namespace {

int presetOf(const std::string& name) {
  if (name == "ultrafast") return cv::DISOpticalFlow::PRESET_ULTRAFAST;
  if (name == "medium") return cv::DISOpticalFlow::PRESET_MEDIUM;
  return cv::DISOpticalFlow::PRESET_FAST;
}

}  // namespace

DenseFlow::DenseFlow(const std::string& preset) : flow_(cv::DISOpticalFlow::create(presetOf(preset))) {
  // The presets' finest level is meant for images twice as large, and would be half of what the cells can hold.
  flow_->setFinestScale(std::max(0, flow_->getFinestScale() - 1));
}

cv::Mat2f DenseFlow::compute(const cv::Mat1b& previous, const cv::Mat1b& current) {
  // From current to previous, so that the field lies on the current image; the sign is turned on return. A fresh output
  // each time: DIS would take a filled one as its start, and results would depend on what came before.
  cv::Mat flow;
  flow_->calc(current, previous, flow);
  flow *= -1.0;
  return flow;
}

cv::Mat1f flowAmplitude(const cv::Mat2f& flow) {
  cv::Mat1f amplitude(flow.size());
  for (int y = 0; y < flow.rows; ++y) {
    const cv::Vec2f* in = flow[y];
    float* out = amplitude[y];
    for (int x = 0; x < flow.cols; ++x) out[x] = std::sqrt(in[x][0] * in[x][0] + in[x][1] * in[x][1]);  // eq. (1)
  }
  return amplitude;
}

}  // namespace semantic_vslam
