// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "core/map/map.h"
#include "semantic_vslam/core/geometry/se3.h"

namespace semantic_vslam {

struct PoseGraphConfig {
  int min_shared = 100;
  int iterations = 50;
  double translation_sigma_m = 0.01;
  double rotation_sigma_rad = 0.005;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("min_shared", min_shared, 15, 1000,
            "landmarks that two keyframes must share for an edge of the essential graph");
    v.field("iterations", iterations, 1, 1000, "most solver steps");
    v.field("translation_sigma_m", translation_sigma_m, 1e-4, 1.0,
            "error of one edge's translation; only its ratio to the rotation's matters: 1 cm to 0.3 degrees, what "
            "visual odometry drifts by between two keyframes at room scale");
    v.field("rotation_sigma_rad", rotation_sigma_rad, 1e-4, 1.0, "error of one edge's rotation");
  }
};

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
MapSolution solve(const PoseGraphProblem& problem, const PoseGraphConfig& config, const std::atomic<bool>* abort);

/// Completes a solution that moves the whole map (pose graph, global adjustment) with what its problem did not hold:
/// keyframes made since move rigidly with their parent, landmarks with their reference keyframe.
void carryAlong(const Map& map, MapSolution& solution);

}  // namespace semantic_vslam
