// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

namespace semantic_vslam {

/// Where each cell's surface was in the previous frame, by the flow: what everything that is carried along reads.
/// @param flow_cells  grid size, cells: x - (position in the previous frame)
/// @param previous_depth_m, surface_m  GridFrame's: metres, 0 = unknown  @param dt_s  time between the frames
/// @return grid size, cells; NaN where the flow comes from outside the image, and where the surface cannot be the one
///         that was there because it lies behind it: background that something uncovered. A hole lies where its
///         surroundings do: a black screen behind who leaves it, one in dark clothes with their wearer
cv::Mat2f traceBack(const cv::Mat2f& flow_cells, const cv::Mat1f& previous_depth_m, const cv::Mat1f& surface_m,
                    double dt_s);

/// Brings a map of the previous frame to the present one, bilinear.
/// @param map  grid size  @param source  of traceBack()  @param fallback  value where the source is lost
cv::Mat1f carryAlong(const cv::Mat1f& map, const cv::Mat2f& source, float fallback);

}  // namespace semantic_vslam
