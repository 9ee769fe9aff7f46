// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "core/segmentation/region_growth.h"

namespace semantic_vslam {

/// What masks that are too large show of the background along their borders, of up to width_px: pixels that a depth
/// edge parts from the object in front of them, and pixels that continue the plane outside the mask up to where the
/// object begins. Where that plane goes on beyond width_px, the mask is rather too small, and nothing is cut.
/// @param masks     of labelled pixels; the others are background
/// @param labelled  those pixels, in raster order
/// @param steps     of the same masks
/// @param bands     255 on such pixels, else 0; @param scratch  memory
void findBands(const ConnectedRegions& masks, const std::vector<cv::Point>& labelled, const Steps& steps,
               const cv::Mat1f& depth_m, int width_px, cv::Mat1b& bands, cv::Mat1b& scratch);

}  // namespace semantic_vslam
