// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include "core/motion/work_grid.h"
#include "semantic_vslam/core/motion/motion_config.h"

namespace semantic_vslam {

/// Plane homography that explains the camera's motion between two frames.
struct HomographyMotion {
  bool valid = false;
  cv::Matx33d H_current_previous = cv::Matx33d::eye();  ///< cells of the previous frame to cells of the present one
  int inliers = 0;
};

/// Fits the homography by RANSAC to the flow at textured cells, spread evenly, that were static in the previous frame.
/// @param flow_cells  grid size, cells: x - (position in the previous frame)
/// @param static_weight  grid size, 0 .. 1; cells below 0.5 are left out; empty: all are used
HomographyMotion estimateHomography(const GridFrame& current, const cv::Mat2f& flow_cells,
                                    const cv::Mat1f& static_weight, const WorkGrid& grid,
                                    const HomographyConfig& config);

/// The previous gray image as the homography says the present camera would see it, reduced to the grid; pixels it did
/// not see are taken from the present image, so that no flow arises there.
cv::Mat1b warpPrevious(const GridFrame& previous, const GridFrame& current, const HomographyMotion& motion);

}  // namespace semantic_vslam
