// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/dense/waiting_keyframes.h"

#include <algorithm>
#include <utility>

namespace semantic_vslam {

void WaitingKeyframes::add(DenseInput keyframe) { waiting_.push_back(std::move(keyframe)); }

void WaitingKeyframes::place(const std::vector<KeyframePose>& poses, DenseMapper& map) {
  std::deque<DenseInput> still_waiting;
  for (DenseInput& keyframe : waiting_) {
    const auto own =
        std::find_if(poses.begin(), poses.end(), [&](const auto& pose) { return pose.keyframe == keyframe.id; });
    if (own == poses.end()) {
      still_waiting.push_back(std::move(keyframe));
    } else {
      map.add(keyframe.id, keyframe.frame, keyframe.labels, keyframe.dynamic, own->T_world_camera);
    }
  }
  while (still_waiting.size() > kMost) still_waiting.pop_front();
  waiting_ = std::move(still_waiting);
}

void WaitingKeyframes::keepOnly(const std::function<bool(KeyframeId)>& wanted) {
  const auto unwanted = [&](const DenseInput& keyframe) { return !wanted(keyframe.id); };
  waiting_.erase(std::remove_if(waiting_.begin(), waiting_.end(), unwanted), waiting_.end());
}

}  // namespace semantic_vslam
