// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "core/map/map.h"
#include "core/mapping/map_maintenance.h"
#include "point_scene.h"

namespace semantic_vslam {

/// A map that grows by views of one scene.
class MappedScene : public ::testing::Test {
 protected:
  /// A keyframe that sees the scene, matched to the landmarks of the points it sees.
  KeyframeId addView(const SE3& T_camera_world) {
    std::vector<int> visible;
    TrackedFrame frame = scene_.frame(next_index_++, T_camera_world, 0.0, 0.0, &visible);
    frame.T_camera_world = T_camera_world;
    for (std::size_t i = 0; i < visible.size(); ++i) frame.landmarks[i] = landmark_of_point_[visible[i]];
    const KeyframeId id = insertKeyframe(map_, frame, SensorConfig(), MapMaintenanceConfig());
    for (std::size_t i = 0; i < visible.size(); ++i) {
      landmark_of_point_[visible[i]] = map_.keyframe(id)->landmarks[i];
    }
    return id;
  }

  PointScene scene_{300};
  std::vector<LandmarkId> landmark_of_point_ = std::vector<LandmarkId>(300);
  Map map_;
  std::uint64_t next_index_ = 0;
};

}  // namespace semantic_vslam
