// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/loop/loop_corrector.h"

#include "core/map/fuse_landmarks.h"
#include "core/map/visibility.h"

namespace semantic_vslam {
namespace {

/// The matches that verified the loop: what the current keyframe shows becomes one with the old landmark.
void mergeMatches(Map& map, const LoopClosure& closure) {
  for (std::size_t i = 0; i < closure.landmarks.size(); ++i) {
    const LandmarkId old = closure.landmarks[i];
    if (!old.valid() || map.landmark(old) == nullptr) continue;
    const LandmarkId present = map.keyframe(closure.current)->landmarks[i];
    if (present.valid()) {
      map.fuseLandmarks(present, old);
    } else if (map.addObservation(closure.current, static_cast<int>(i), old)) {
      map.refreshLandmark(old);
    }
  }
}

}  // namespace

PoseGraphProblem selectLoop(const Map& map, const LoopClosure& closure, const LoopCorrectorConfig& config) {
  return selectEssentialGraph(map, {{closure.current, closure.matched, closure.T_current_matched}}, config.graph);
}

bool applyLoop(Map& map, const LoopClosure& closure, MapSolution solution, std::uint64_t version,
               double virtual_baseline_m, const LoopCorrectorConfig& config) {
  if (map.keyframe(closure.current) == nullptr || map.keyframe(closure.matched) == nullptr) return false;
  const auto new_side = keyframeGroup(map, closure.current, config.neighbours);
  const auto old_side = keyframeGroup(map, closure.matched, config.neighbours);
  carryAlong(map, solution);
  if (!map.apply(solution, version)) return false;

  mergeMatches(map, closure);
  for (const KeyframeId id : new_side) {
    fuseInto(map, landmarksSeenBy(map, old_side), id, virtual_baseline_m, config.fuse_radius_px);
  }
  map.addLoopEdge(closure.current, closure.matched);
  map.bumpVersion();
  return true;
}

}  // namespace semantic_vslam
