// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <opencv2/video/tracking.hpp>
#include <string>

namespace semantic_vslam {

/// Pyramidal dense optical flow between two gray images (DIS).
class DenseFlow {
 public:
  /// @param preset  of DenseFlowConfig
  explicit DenseFlow(const std::string& preset);

  /// @param previous, current  8-bit gray, same size, continuous in memory
  /// @return for each pixel x of `current`, x - (its position in `previous`); px of these images.
  cv::Mat2f compute(const cv::Mat1b& previous, const cv::Mat1b& current);

 private:
  cv::Ptr<cv::DISOpticalFlow> flow_;
};

/// Flow amplitude, eq. (1): f = sqrt(fu^2 + fv^2).
cv::Mat1f flowAmplitude(const cv::Mat2f& flow);

}  // namespace semantic_vslam
