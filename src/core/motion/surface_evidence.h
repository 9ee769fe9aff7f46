// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

namespace semantic_vslam {

/// What a frame says of each cell, after what belongs to one surface has been put together.
struct SurfaceEvidence {
  cv::Mat1f log_odds;  ///< above 0 = moving; empty if there was none
  cv::Mat1f semantic;  ///< 0 .. 1, probability that it is dynamic by a mask; NaN = unknown; empty if there was none
};

/// Shares the evidence of motion along surfaces, and brings carried masks to the edges in depth: a rim of wall that a
/// coarse or carried mask holds is outvoted by the rest of the wall.
/// @param log_odds  of MotionMemory, may be empty  @param semantic  of MaskPropagation::dynamicNow(), may be empty
/// @param depth_m  grid size, metres, 0 = none
SurfaceEvidence shareAlongSurfaces(const cv::Mat1f& log_odds, const cv::Mat1f& semantic, const cv::Mat1f& depth_m);

}  // namespace semantic_vslam
