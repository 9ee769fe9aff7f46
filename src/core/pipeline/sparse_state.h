// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>

#include "core/features/place_index.h"
#include "core/map/map.h"
#include "core/tracking/tracker.h"
#include "core/tracking/trajectory_log.h"

namespace semantic_vslam {

/// Runs what it is given while nobody else uses the map: at once where one thread does everything, under a lock where
/// the map's upkeep has a thread of its own. The long computations between two such turns work on copies.
using Alone = std::function<void(const std::function<void()>&)>;

/// The sparse map and all that must change with it. Knows no thread.
struct SparseState {
  SparseState(const PlaceIndexConfig& place_config, const TrackerConfig& tracker_config)
      : places(place_config), tracker(tracker_config) {}

  /// Runs a change of the map that may move keyframes; tracking's last frame moves with its reference.
  /// @param change  () -> bool, whether the map was changed  @return the same
  template <class Change>
  bool change(const Change& change) {
    const Keyframe* reference = map.keyframe(tracker.reference());
    const SE3 T_reference_world_before = reference ? reference->T_camera_world : SE3::Identity();
    if (!change()) return false;
    ++poses_version;
    reference = map.keyframe(tracker.reference());
    if (reference) tracker.followReference(T_reference_world_before, reference->T_camera_world);
    return true;
  }

  Map map;
  PlaceIndex places;
  TrajectoryLog trajectory;
  Tracker tracker;
  std::uint64_t poses_version = 0;  ///< grows with every change of the keyframes or their poses
};

}  // namespace semantic_vslam
