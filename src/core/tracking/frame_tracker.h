// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/map/map.h"
#include "core/map/tracked_frame.h"
#include "core/optimization/pose_optimizer.h"
#include "semantic_vslam/core/camera/sensor_config.h"

namespace semantic_vslam {

struct FrameTrackerConfig {
  SensorConfig sensor;  ///< of all stages; a group of keys of its own beside `tracking` (SparseSlamConfig)
  double search_radius_px = 15.0;
  int minimum_matches = 20;
  PoseOptimizerConfig pose;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("search_radius_px", search_radius_px, 2.0, 100.0,
            "how far from its predicted place a point of the last frame is looked for, px at full size");
    v.field("minimum_matches", minimum_matches, 6, 500,
            "with fewer matches than this the search is tried again with twice the radius, then fails");
    v.group("pose", pose);
  }
};

/// Outcome of one attempt to find a frame's pose.
struct PoseEstimate {
  bool success = false;
  int matches = 0;
  int inliers = 0;
  Matrix6d covariance = Matrix6d::Identity();  ///< of the left perturbation of T_camera_world (m, rad)
};

/// Finds current's pose from the points that the last frame saw: its landmarks, and its own points with depth that are
/// no landmarks yet. On success current has pose and matches (outliers removed).
/// @param predicted_T_camera_world  where the motion model expects the camera
PoseEstimate trackFromLastFrame(const Map& map, const TrackedFrame& last, const SE3& predicted_T_camera_world,
                                const FrameTrackerConfig& config, TrackedFrame& current);

/// The same from a keyframe's landmarks, by descriptors alone: for when the motion model was wrong.
PoseEstimate trackFromKeyframe(const Map& map, const Keyframe& keyframe, const SE3& start_T_camera_world,
                               const FrameTrackerConfig& config, TrackedFrame& current);

/// Optimises current's pose on all its landmarks and drops the matches that do not fit.
PoseEstimate refinePose(const Map& map, const FrameTrackerConfig& config, TrackedFrame& current);

}  // namespace semantic_vslam
