// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <vector>

#include "core/map/map.h"
#include "core/map/tracked_frame.h"
#include "semantic_vslam/core/camera/sensor_config.h"

namespace semantic_vslam {

struct MapMaintenanceConfig {
  int min_new_points = 100;
  double min_found_share = 0.25;
  int probation_keyframes = 3;
  double redundant_share = 0.85;
  double fuse_radius_px = 3.0;
  int fuse_neighbours = 10;
  int min_tree_keyframes = 5;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("min_new_points", min_new_points, 0, 1000,
            "where fewer close points are at hand, the nearest points are taken up to this number");
    v.field(
        "min_found_share", min_found_share, 0.0, 1.0,
        "a landmark on probation is dropped if it is found in less than this share of the frames that should see it");
    v.field("probation_keyframes", probation_keyframes, 1, 20,
            "keyframes within which a new landmark must be seen by a second one");
    v.field(
        "redundant_share", redundant_share, 0.5, 1.0,
        "a keyframe is dropped when this share of its close landmarks is seen by 3 others, as large or larger; 0.85 "
        "instead of ORB-SLAM2's 0.9 keeps a map of one place from growing: 5 % in ten passes");
    v.field("fuse_radius_px", fuse_radius_px, 0.5, 20.0, "search radius for duplicates of a landmark, px at full size");
    v.field("fuse_neighbours", fuse_neighbours, 1, 50,
            "covisible keyframes whose landmarks are merged with a new one's");
    v.field("min_tree_keyframes", min_tree_keyframes, 1, 100,
            "a new map that is lost again before it has this many and was never joined is dropped: it shows a second "
            "or two of the way, and loop closing wants three in a row that point at one place and neighbours of theirs "
            "to confirm it");
  }
};

/// Makes a keyframe of a tracked frame, and landmarks of its close static points that have none.
KeyframeId insertKeyframe(Map& map, const TrackedFrame& frame, const SensorConfig& sensor,
                          const MapMaintenanceConfig& config);

/// Drops landmarks of the newest keyframe's tree, made in the last few keyframes, that tracking does not confirm.
/// @return landmarks dropped
int cullRecentLandmarks(Map& map, KeyframeId newest, const MapMaintenanceConfig& config);

/// Finds landmarks in a keyframe that does not see them yet: adds the observation, or merges with the landmark that the
/// feature already has (the one seen by more keyframes stays).
/// @return observations added and landmarks merged
int fuseInto(Map& map, const std::vector<LandmarkId>& landmarks, KeyframeId keyframe, double virtual_baseline_m,
             double radius_px);

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
