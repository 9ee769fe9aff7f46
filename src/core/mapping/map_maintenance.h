// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <vector>

#include "core/map/map.h"
#include "core/map/tracked_frame.h"
#include "semantic_vslam/core/camera/sensor_config.h"
#include "semantic_vslam/core/mapping/mapping_config.h"

namespace semantic_vslam {

/// Makes a keyframe of a tracked frame, and landmarks of its close static points that have none.
KeyframeId insertKeyframe(Map& map, const TrackedFrame& frame, const SensorConfig& sensor,
                          const MapMaintenanceConfig& config);

/// Drops landmarks of the newest keyframe's tree, made in the last few keyframes, that tracking does not confirm.
/// @return landmarks dropped
int cullRecentLandmarks(Map& map, KeyframeId newest, const MapMaintenanceConfig& config);

/// fuseInto() both ways between a keyframe and its covisible neighbours.
int fuseWithNeighbours(Map& map, KeyframeId keyframe, double virtual_baseline_m, const MapMaintenanceConfig& config);

/// Removes covisible keyframes that add nothing: most of their close landmarks are seen by 3 others at the same or a
/// finer scale. `centre` and the first keyframe of a tree stay.
/// @param keep            stays too (tracking's reference), may be invalid
/// @param before_removal  called with each keyframe that goes, while it is still there
/// @return keyframes removed
int cullRedundantKeyframes(Map& map, KeyframeId centre, KeyframeId keep, const SensorConfig& sensor,
                           const MapMaintenanceConfig& config,
                           const std::function<void(const Keyframe&)>& before_removal);

}  // namespace semantic_vslam
