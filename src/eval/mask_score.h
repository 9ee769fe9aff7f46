// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

namespace semantic_vslam {

/// Scores binary masks against true ones, all pixels of all frames counted together.
class MaskScore {
 public:
  /// @param estimate, truth  same size, 8-bit; a pixel counts as set from 128 on
  void add(const cv::Mat1b& estimate, const cv::Mat1b& truth);

  /// Share of pixels set in either that are set in both; 1 if none is set in either.
  double iou() const;
  /// Share of estimated pixels that are true; 1 if none was estimated.
  double precision() const;
  /// Share of true pixels that were estimated; 1 if none is true.
  double recall() const;
  std::size_t frames() const { return frames_; }

 private:
  std::uint64_t both_px_ = 0, only_estimate_px_ = 0, only_truth_px_ = 0;
  std::size_t frames_ = 0;
};

}  // namespace semantic_vslam
