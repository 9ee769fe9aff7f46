// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

namespace semantic_vslam {

/// Picture of a flow field in Munsell-style colours: the direction is the hue, with red, yellow, green, blue and purple
/// spread as on Munsell's circle (after Baker et al., IJCV 2011); the amplitude is the saturation, white = no flow.
/// @param flow_px  2 x float32; NaN is painted black
/// @param full_scale_px  amplitude of full saturation; 0 or less: the 99th percentile of the field, at least 1 px
cv::Mat3b flowPicture(const cv::Mat2f& flow_px, double full_scale_px = 0.0);

}  // namespace semantic_vslam
