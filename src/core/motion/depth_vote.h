// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include "core/motion/place_lookup.h"
#include "core/motion/work_grid.h"
#include "semantic_vslam/core/motion/motion_config.h"

namespace semantic_vslam {

/// Depth as an earlier frame saw it.
struct DepthReference {
  PlacedFrame place;
  cv::Mat1f depth_low_m;          ///< GridFrame's
  cv::Mat1f dynamic_probability;  ///< 0 .. 1, of that frame
};

/// What an earlier depth image says of the present one: each cell's surface is moved into the earlier camera.
/// Nearer than everything seen there: something came into space that was seen to be free (someone walks, also along the
/// optical axis). At the depth seen there: it stood still since. Behind it: it was hidden, no vote.
struct DepthVote {
  cv::Mat1f entered;  ///< 0 .. 1: how clearly the surface lies in space that was seen free
  cv::Mat1f stayed;   ///< 0 .. 1: how clearly it was there then, and static
};

/// @param rows_in_turn  the first row to look at, and the step to the next; nothing is said of the others
DepthVote voteByDepth(const PlacedFrame& current, const DepthReference& reference, const WorkGrid& grid,
                      const RigidFlowConfig& config, cv::Range rows_in_turn = {0, 1});

}  // namespace semantic_vslam
