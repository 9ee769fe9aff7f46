// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "semantic_vslam/core/tracking/trajectory_log.h"

#include <cassert>

namespace semantic_vslam {

void TrajectoryLog::add(Stamp stamp, const SE3& T_camera_world, const Keyframe& reference) {
  entries_.push_back({stamp, reference.id, T_camera_world * reference.T_camera_world.inverse()});
}

void TrajectoryLog::keyframeRemoved(const Map& map, const Keyframe& keyframe) {
  const Keyframe* parent = map.keyframe(keyframe.parent);
  assert(parent);  // the first of a tree stays
  heirs_[keyframe.id] = {parent->id, keyframe.T_camera_world * parent->T_camera_world.inverse()};
}

std::vector<TimedPose> TrajectoryLog::poses(const Map& map) const {
  std::vector<TimedPose> out;
  out.reserve(entries_.size());
  for (const Entry& entry : entries_) {
    SE3 T_camera_reference = entry.T_camera_reference;
    KeyframeId reference = entry.reference;
    for (auto heir = heirs_.find(reference); heir != heirs_.end(); heir = heirs_.find(reference)) {
      T_camera_reference = T_camera_reference * heir->second.T_removed_keyframe;
      reference = heir->second.keyframe;
    }
    const Keyframe* keyframe = map.keyframe(reference);
    assert(keyframe);
    if (!map.isPlaced(reference)) continue;
    out.push_back({entry.stamp, (T_camera_reference * keyframe->T_camera_world).inverse()});
  }
  return out;
}

void TrajectoryLog::clear() {
  entries_.clear();
  heirs_.clear();
}

}  // namespace semantic_vslam
