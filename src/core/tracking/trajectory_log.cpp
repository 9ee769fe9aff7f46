// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/tracking/trajectory_log.h"

#include <algorithm>
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

void TrajectoryLog::treesRemoved(const Map& map) {
  const auto gone = [&](const Entry& entry) { return map.keyframe(inherited(entry).reference) == nullptr; };
  entries_.erase(std::remove_if(entries_.begin(), entries_.end(), gone), entries_.end());
}

TrajectoryLog::Entry TrajectoryLog::inherited(Entry entry) const {
  for (auto heir = heirs_.find(entry.reference); heir != heirs_.end(); heir = heirs_.find(entry.reference)) {
    entry.T_camera_reference = entry.T_camera_reference * heir->second.T_removed_keyframe;
    entry.reference = heir->second.keyframe;
  }
  return entry;
}

std::vector<TimedPose> TrajectoryLog::poses(const Map& map, std::size_t most) const {
  const std::size_t stride = 1 + entries_.size() / std::max<std::size_t>(most, 1);
  std::vector<TimedPose> out;
  out.reserve(entries_.size() / stride + 1);
  const auto roots = map.roots();
  for (std::size_t i = 0; i < entries_.size(); i += stride) {
    const Entry entry = inherited(entries_[i]);
    const Keyframe* keyframe = map.keyframe(entry.reference);
    assert(keyframe);
    if (roots.at(entry.reference) != map.worldRoot()) continue;
    out.push_back({entry.stamp, (entry.T_camera_reference * keyframe->T_camera_world).inverse()});
  }
  return out;
}

void TrajectoryLog::clear() {
  entries_.clear();
  heirs_.clear();
}

}  // namespace semantic_vslam
