// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/map/map.h"
#include "core/map/tracked_frame.h"
#include "core/optimization/frame_pose.h"
#include "semantic_vslam/core/tracking/tracking_config.h"

namespace semantic_vslam {

/// Finds current's pose from the points that the last frame saw: its landmarks, and its own points with depth that are
/// no landmarks yet. On success current has pose and matches (outliers removed).
/// @param predicted_T_camera_world  where the motion model expects the camera
PoseEstimate trackFromLastFrame(const Map& map, const TrackedFrame& last, const SE3& predicted_T_camera_world,
                                const FrameTrackerConfig& config, TrackedFrame& current);

/// The same from a keyframe's landmarks, by descriptors alone: for when the motion model was wrong.
PoseEstimate trackFromKeyframe(const Map& map, const Keyframe& keyframe, const SE3& start_T_camera_world,
                               const FrameTrackerConfig& config, TrackedFrame& current);

}  // namespace semantic_vslam
