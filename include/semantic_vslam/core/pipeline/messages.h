// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "semantic_vslam/core/common/ids.h"
#include "semantic_vslam/core/common/stamp.h"
#include "semantic_vslam/core/geometry/timed_pose.h"
#include "semantic_vslam/core/motion/motion_result.h"
#include "semantic_vslam/core/tracking/tracking_state.h"

namespace semantic_vslam {

// What goes between the stages, by call, from thread to thread or as ROS messages. Images are shared, never written to.

/// Labels of one frame.
struct FrameLabels {
  Stamp stamp;
  cv::Mat1b labels;  ///< height x width, indices into the network's LabelSet
};

/// A frame that tracking kept. Who needs its images finds them by the stamp.
struct KeyframeNotice {
  KeyframeId id;             ///< unique together with map_id
  std::uint32_t map_id = 0;  ///< of MapSnapshot
  Stamp stamp;
};

/// Where a frame lies that is no keyframe: beside one, so that it moves with it.
struct FramePlace {
  Stamp stamp;
  std::uint32_t map_id = 0;  ///< of MapSnapshot
  KeyframeId keyframe;       ///< its reference in the sparse map
  SE3 T_keyframe_camera = SE3::Identity();
};

/// The sparse map after a step or after its upkeep: one state of it, which nobody changes any more.
struct MapSnapshot {
  std::uint32_t map_id = 0;   ///< changes when another map takes the place of the last one: older keyframes are gone
  std::uint32_t origin = 0;   ///< map_id that a loaded map had when it was saved; 0: none was loaded
  std::uint64_t version = 0;  ///< grows with every change of the keyframes or their poses, within one map_id
  std::vector<KeyframePose> poses;   ///< of the keyframes whose place in the world is known, in the order of ids
  std::vector<KeyframeId> unplaced;  ///< keyframes of a new map that is not joined with the world yet
  std::size_t landmarks = 0, loops = 0;

  std::size_t keyframes() const { return poses.size() + unplaced.size(); }
};

/// What became of a frame.
struct TrackingOutput {
  TrackingEstimate tracking;
  cv::Mat1b removed;  ///< what tracking left out: height x width, 0..255; empty = nothing
  bool is_keyframe = false;
  bool new_world = false;                 ///< what was mapped before is dropped: poses are relative to another map now
  std::vector<KeyframeNotice> keyframes;  ///< made in this step: k1 with the first map, and this frame
  std::optional<FramePlace> place;        ///< of a posed frame that is no keyframe, while maps may change
  std::shared_ptr<const MapSnapshot> map;
  std::vector<TimedPose> path;          ///< of all frames whose place in the world is known, as wished
  std::vector<Eigen::Vector3d> points;  ///< landmarks whose place in the world is known, metres, as wished

  bool posed() const { return tracking.state == TrackingState::kOk; }
};

/// What the whole way made of one frame.
struct StepResult : TrackingOutput {
  MotionResult motion;
  /// A keyframe that was mapped in this step, and what was removed from it.
  struct Mapped {
    Stamp stamp;
    cv::Mat1b removed;
  };
  std::vector<Mapped> mapped;  ///< by Pipeline only: elsewhere it comes later

  SE3 T_world_camera() const { return tracking.T_camera_world.inverse(); }  ///< a prediction while RECENTLY_LOST
};

}  // namespace semantic_vslam
