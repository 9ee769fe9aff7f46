// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "core/features/place_index.h"
#include "core/loop/loop_detector.h"
#include "core/loop/relocalizer.h"
#include "core/map/map.h"
#include "core/map/tracked_frame.h"

namespace semantic_vslam {

/// Joins two trees of keyframes (see Map) at a place that both know: the younger one moves, whole and rigidly, to where
/// the closure sees it in the older one's frame of reference, and is hung into it. Depth gives both the same scale.
/// What the closure then still asks for is that of a loop, whose correction merges the landmarks of both. Nothing to do
/// where the closure lies within one tree.
/// @param closure  its T_current_world follows if the older tree is the current keyframe's
/// @return whether there were two trees
bool joinTrees(Map& map, LoopClosure& closure);

/// Trees besides the camera's own that show too little for the camera to come upon them again: few keyframes, or all of
/// them from one moment. The world's may be one: the oldest of the others is the world then.
/// @param camera_at  any keyframe of the camera's tree  @param min_s  from a tree's first keyframe to its last
/// @return their roots, oldest first
std::vector<KeyframeId> abandonedTrees(const Map& map, KeyframeId camera_at, int min_keyframes, double min_s);

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

/// Looks for the world in frames that are tracked in a new map beside it. Tracking calls it with every frame, so that a
/// known place joins the maps at once; loop closing, which asks for several keyframes there, does it otherwise.
class WorldSeeker {
 public:
  WorldSeeker(const FramePoseConfig& tracker, const RelocalisationConfig& relocalisation)
      : tracker_(tracker), relocalisation_(relocalisation) {}

  /// @param T_camera_own  the frame's pose in the new map
  /// @return once frames agree on it: where the world sees this one. `current` is left to the caller, who makes a
  /// keyframe of the frame.
  std::optional<LoopClosure> seek(const Map& map, const PlaceIndex& places, const TrackedFrame& frame,
                                  const SE3& T_camera_own);
  void reset() {
    evidence_.reset();
    frames_ = 0;
  }

 private:
  FramePoseConfig tracker_;
  RelocalisationConfig relocalisation_;
  JoinEvidence evidence_;
  int frames_ = 0;  ///< sought in since the camera is beside the world
};

}  // namespace semantic_vslam
