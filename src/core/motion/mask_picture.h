// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

namespace semantic_vslam {

/// The colour image with what moves in red, the redder the surer; what stands still is left as it is.
/// @param dynamic  height x width, probability that a pixel moves, 0..255; below 128 it stands still; empty: nothing
///                 moves
cv::Mat3b maskPicture(const cv::Mat3b& bgr, const cv::Mat1b& dynamic);

}  // namespace semantic_vslam
