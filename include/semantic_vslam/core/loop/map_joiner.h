// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "semantic_vslam/core/loop/loop_detector.h"
#include "semantic_vslam/core/map/map.h"

namespace semantic_vslam {

/// Joins two trees of keyframes (see Map) at a place that both know: the younger one moves, whole and rigidly, to where
/// the closure sees it in the older one's frame of reference, and is hung into it. Depth gives both the same scale.
/// What the closure then still asks for is that of a loop, whose correction merges the landmarks of both. Nothing to do
/// where the closure lies within one tree.
/// @param closure  its T_current_world follows if the older tree is the current keyframe's
/// @return whether there were two trees
bool joinTrees(Map& map, LoopClosure& closure);

/// Collects frames of a new map that were also found in the old one. Each tells where the new map lies; that is
/// believed when three in a row say the same, which frames mistaken for another place, each in its own way, do not.
class JoinEvidence {
 public:
  /// @param T_new_camera, T_old_camera  one frame's pose in either map  @return whether that settles it
  bool add(const SE3& T_new_camera, const SE3& T_old_camera);
  void reset() { agreeing_ = 0; }

 private:
  SE3 T_old_new_ = SE3::Identity();  ///< by the last frame
  int agreeing_ = 0;
};

}  // namespace semantic_vslam
