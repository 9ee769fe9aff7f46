// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "core/common/abort_flag.h"
#include "core/map/map.h"
#include "semantic_vslam/core/geometry/se3.h"
#include "semantic_vslam/core/optimization/optimization_config.h"

namespace semantic_vslam {

/// Measured pose of keyframe b in the frame of keyframe a.
struct RelativePose {
  KeyframeId a, b;
  SE3 T_a_b = SE3::Identity();
};

struct PoseGraphNode {
  KeyframeId id;
  SE3 T_camera_world = SE3::Identity();
  bool fixed = false;
};

/// Copy of a map's graph of poses; it can be solved while the map lives on.
struct PoseGraphProblem {
  std::uint64_t map_version = 0;  ///< for Map::apply
  std::vector<PoseGraphNode> nodes;
  std::vector<RelativePose> edges;
};

/// The essential graph of ORB-SLAM (Mur-Artal and Tardos 2015, section III.D): spanning tree, strong covisibility and
/// the loops closed before, all as the map has them now; and new loop edges, which it is to be bent to. The map's first
/// keyframe is fixed.
PoseGraphProblem selectEssentialGraph(const Map& map, const std::vector<RelativePose>& loops,
                                      const PoseGraphConfig& config);

/// Poses that agree best with all edges (least squares over SE(3)).
/// @param config  valid (its owner has validated it)
/// @param abort   looked at between steps; may be nullptr. What was reached till then is the solution.
/// @return the poses of the free nodes; no landmarks.
MapSolution solve(const PoseGraphProblem& problem, const PoseGraphConfig& config, const AbortFlag* abort);

/// Completes a solution that moves the whole map (pose graph, global adjustment) with what its problem did not hold:
/// keyframes made since move rigidly with their parent, landmarks with their reference keyframe.
void carryAlong(const Map& map, MapSolution& solution);

}  // namespace semantic_vslam
