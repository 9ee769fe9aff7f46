// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

namespace semantic_vslam {

/// Weighted mean over surroundings that are connected in depth: the recursive domain transform (Gastal and Oliveira,
/// ACM ToG 2011, section 4.2) with the relative depth step as guide. What a surface shows in one place counts for all
/// of it nearby, and nothing passes a depth edge.
/// @param values, weights  same size; weights >= 0
/// @param depth_m  0 = none: a hole belongs to whatever it is between, at a cost
/// @param reach_cells  standard deviation of the filter on an even surface, cells
/// @return weighted mean; 0 where no weight reaches
cv::Mat1f filterAlongDepth(const cv::Mat1f& values, const cv::Mat1f& weights, const cv::Mat1f& depth_m,
                           float reach_cells);

}  // namespace semantic_vslam
