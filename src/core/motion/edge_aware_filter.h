// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

namespace semantic_vslam {

/// Means over surroundings that are connected in depth: the recursive domain transform (Gastal and Oliveira, ACM ToG
/// 2011, section 4.2) with the relative depth step as guide. What a surface shows in one place counts for all of it
/// nearby, and nothing passes a depth edge. The ratio of a channel of weighted values to one of the weights is the
/// weighted mean.
/// @param channels  four images, filtered in place, each by itself
/// @param depth_m   same size, 0 = none: a hole belongs to whatever it is between, at a cost
/// @param reach_cells  standard deviation of the filter on an even surface, cells
void filterAlongDepth(cv::Mat4f& channels, const cv::Mat1f& depth_m, float reach_cells);

}  // namespace semantic_vslam
