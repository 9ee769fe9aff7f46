// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <unordered_map>
#include <vector>

#include "core/map/map.h"
#include "semantic_vslam/core/geometry/timed_pose.h"

namespace semantic_vslam {

/// Every frame's pose, kept relative to its reference keyframe, so that it follows when the map is corrected.
class TrajectoryLog {
 public:
  void add(Stamp stamp, const SE3& T_camera_world, const Keyframe& reference);
  /// Call before a keyframe leaves the map: poses relative to it go on relative to its parent.
  void keyframeRemoved(const Map& map, const Keyframe& keyframe);
  /// Call after whole trees have left the map: poses relative to their keyframes are dropped.
  void treesRemoved(const Map& map);
  /// @param most  of more frames every second, third, ... is taken
  /// @return the poses whose place in the world is known, at the keyframes' present places, in the order they were
  /// added.
  std::vector<TimedPose> poses(const Map& map, std::size_t most = std::numeric_limits<std::size_t>::max()) const;
  std::size_t size() const { return entries_.size(); }
  void clear();

 private:
  struct Entry {
    Stamp stamp;
    KeyframeId reference;
    SE3 T_camera_reference;
  };
  struct Heir {
    KeyframeId keyframe;
    SE3 T_removed_keyframe;
  };
  /// The same entry, relative to what took the place of a removed reference.
  Entry inherited(Entry entry) const;

  std::vector<Entry> entries_;
  std::unordered_map<KeyframeId, Heir> heirs_;
};

}  // namespace semantic_vslam
