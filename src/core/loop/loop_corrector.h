// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>

#include "core/loop/loop_detector.h"
#include "core/map/map.h"
#include "core/optimization/pose_graph.h"
#include "semantic_vslam/core/loop/loop_config.h"

namespace semantic_vslam {

/// Copies what bending the map to a loop needs: its essential graph with the loop's edge. Solve it with
/// solve(PoseGraphProblem, ...), then applyLoop().
PoseGraphProblem selectLoop(const Map& map, const LoopClosure& closure, const LoopCorrectorConfig& config);

/// Bends the map to a closed loop and joins both visits: poses and landmarks (also those made since the graph was
/// copied) move, landmarks of both visits that are the same point become one, the loop becomes an edge, and the map
/// gets a new version, so that adjustments copied before are refused. A global bundle adjustment should follow.
/// @param version  of the map when the graph was copied
/// @return false, with nothing changed, if the map has another version or a keyframe of the loop is gone.
bool applyLoop(Map& map, const LoopClosure& closure, MapSolution solution, std::uint64_t version,
               double virtual_baseline_m, const LoopCorrectorConfig& config);

}  // namespace semantic_vslam
