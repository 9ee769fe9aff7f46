// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "semantic_vslam/core/geometry/se3.h"

namespace semantic_vslam {

/// How far the pose of a frame can be trusted.
enum class TrackingState {
  kInitialising,  ///< no map yet
  kOk,            ///< the pose comes from the map
  kRecentlyLost,  ///< the map is not seen: the motion model carries the pose on for a moment
  /// No pose in the world; every frame tries to find its place again, the map stays. After a while a new map is begun,
  /// but where that lies is not known until it is joined with the old one: so long it is LOST.
  kLost,
};

const char* stateName(TrackingState state);

/// How the camera moved since the last tracked frame; corrections of the map are not in it.
struct CameraStep {
  SE3 T_current_last = SE3::Identity();
  double seconds = 0.0;  ///< > 0
};

/// What tracking says of a frame.
struct TrackingEstimate {
  TrackingState state = TrackingState::kInitialising;
  SE3 T_camera_world = SE3::Identity();        ///< valid in kOk; a prediction in kRecentlyLost
  Matrix6d covariance = Matrix6d::Identity();  ///< of the left perturbation of T_camera_world (m, rad)
  std::optional<CameraStep> last_step;         ///< measured; nothing for a frame that was predicted or relocalised
  bool relocalised = false;                    ///< the place was recognised, without the frame before
  int features = 0;
  int matches = 0;
  int inliers = 0;
};

}  // namespace semantic_vslam
