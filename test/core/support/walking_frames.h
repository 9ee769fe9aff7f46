// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/support/motion_alone.h"
#include "core/support/quarter_vga.h"
#include "eval/synthetic_room.h"
#include "semantic_vslam/core/pipeline/config.h"
#include "semantic_vslam/core/segmentation/segmenter.h"

namespace semantic_vslam {

constexpr int kFrames = 24;

/// From where somebody stands well in the picture.
inline const std::vector<SyntheticFrame>& frames() {
  static const std::vector<SyntheticFrame> rendered = [] {
    const SyntheticRoom room(makeScenario("walking", 1), quarterVga());
    std::vector<SyntheticFrame> all;
    for (int i = 0; i < kFrames; ++i) {
      all.push_back(room.render(room.frameTime(i + 20)));
      all.back().frame.index = static_cast<std::uint64_t>(i);
    }
    return all;
  }();
  return rendered;
}

/// A network that knows the truth and notes what it was asked for.
class NotingNetwork final : public Segmenter {
 public:
  explicit NotingNetwork(std::vector<int>& asked) : asked_(asked) {}

  const LabelSet& labels() const override { return labels_; }
  Segmentation segment(const cv::Mat3b& bgr) override {
    for (const SyntheticFrame& synthetic : frames()) {
      if (synthetic.frame.bgr.data != bgr.data) continue;
      asked_.push_back(static_cast<int>(synthetic.frame.index));
      return {synthetic.labels};
    }
    return {cv::Mat1b::zeros(bgr.size())};
  }

 private:
  std::vector<int>& asked_;
  LabelSet labels_ = syntheticLabels();
};

inline SystemConfig sparse() {
  SystemConfig config = motionAlone();
  config.dense.enabled = false;
  return config;
}

}  // namespace semantic_vslam
