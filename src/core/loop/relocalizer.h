// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "core/features/place_index.h"
#include "core/map/map.h"
#include "core/map/tracked_frame.h"
#include "core/optimization/frame_pose.h"
#include "core/optimization/pose_ransac.h"
#include "semantic_vslam/core/loop/loop_config.h"

namespace semantic_vslam {

struct RelocalisationResult {
  SE3 T_camera_world = SE3::Identity();
  Matrix6d covariance = Matrix6d::Identity();  ///< of the left perturbation (m, rad)
  KeyframeId keyframe;                         ///< that the frame was recognised by
  int inliers = 0;
  std::vector<LandmarkId> landmarks;  ///< per feature of the frame; invalid id = none
};

/// Pose of a frame from the landmarks of a keyframe that it may show, without a start: descriptor matches, RANSAC on
/// P3P, then two guided searches for the landmarks of the whole group with the optimised pose in between. Accepted with
/// enough landmarks, spread over the image, and a sure position only.
/// @param group  keyframes whose landmarks count; the first one is matched by descriptors
std::optional<RelocalisationResult> relocaliseAt(const Map& map, const std::vector<KeyframeId>& group,
                                                 const TrackedFrame& frame, const FramePoseConfig& tracker,
                                                 const RelocalisationConfig& config);

/// Finds the camera anywhere in the map (Mur-Artal and Tardos 2015, section V.C): the keyframes most like the frame are
/// tried in turn. Nothing is returned rather than a pose of which there are two.
/// @param frame  features, grid and camera are used
/// @param among  keyframes that count; empty = all
std::optional<RelocalisationResult> relocalise(const Map& map, const PlaceIndex& index, const TrackedFrame& frame,
                                               const FramePoseConfig& tracker, const RelocalisationConfig& config,
                                               const std::function<bool(KeyframeId)>& among = {});

/// A keyframe with those it shares most landmarks with, itself first. Empty if it is gone.
std::vector<KeyframeId> keyframeGroup(const Map& map, KeyframeId id, int neighbours);

}  // namespace semantic_vslam
