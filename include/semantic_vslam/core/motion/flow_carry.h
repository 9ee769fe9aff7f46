// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include "semantic_vslam/core/motion/work_grid.h"

namespace semantic_vslam {

/// True if a surface at depth_m cannot be the one that was at previous_depth_m a frame ago because it lies behind it:
/// background that a moving thing uncovered. Holes (0) never are.
/// @param dt_s  time between the frames
inline bool isUncovered(float depth_m, float previous_depth_m, float dt_s) {
  // People recede at 2 m/s at most; the noise of both depths grows with the square of depth.
  return depth_m > 0.0F && previous_depth_m > 0.0F &&
         depth_m - previous_depth_m > 0.03F + 2.0F * dt_s + 0.015F * depth_m * depth_m;
}

/// Brings a map of the previous frame to the present one along the flow.
/// @param map  grid size  @param flow_cells  cells: x - (position in the previous frame)
/// @param fallback  value where the flow comes from outside the image or the surface was uncovered
cv::Mat1f carryWithFlow(const cv::Mat1f& map, const cv::Mat2f& flow_cells, const cv::Mat1f& previous_depth_m,
                        const cv::Mat1f& depth_m, float dt_s, float fallback);

}  // namespace semantic_vslam
