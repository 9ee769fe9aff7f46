// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mutex>

#include "core/features/place_index.h"
#include "core/map/map.h"
#include "core/tracking/tracker.h"
#include "core/tracking/trajectory_log.h"

namespace semantic_vslam {

/// The sparse map and all that must change with it, under one mutex: what tracking, the map's upkeep and loop closing
/// work on together. Functions ending in Locked are called by who holds the mutex.
struct SharedMap {
  SharedMap(const PlaceIndexConfig& place_config, const TrackerConfig& tracker_config)
      : places(place_config), tracker(tracker_config) {}

  /// Runs a change of the map that may move keyframes; tracking's last frame moves with its reference.
  /// @param change  () -> bool, whether the map was changed  @return the same
  template <class Change>
  bool changeLocked(const Change& change) {
    const Keyframe* reference = map.keyframe(tracker.reference());
    const SE3 T_reference_world_before = reference ? reference->T_camera_world : SE3::Identity();
    if (!change()) return false;
    reference = map.keyframe(tracker.reference());
    if (reference) tracker.followReference(T_reference_world_before, reference->T_camera_world);
    return true;
  }

  mutable std::mutex mutex;
  Map map;                   // guarded by mutex
  PlaceIndex places;         // guarded by mutex
  TrajectoryLog trajectory;  // guarded by mutex
  Tracker tracker;           // guarded by mutex, but for prepare(), which is const
};

}  // namespace semantic_vslam
