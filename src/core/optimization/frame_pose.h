// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/map/map.h"
#include "core/map/tracked_frame.h"
#include "core/optimization/pose_optimizer.h"
#include "semantic_vslam/core/optimization/optimization_config.h"

namespace semantic_vslam {

/// Outcome of one attempt to find a frame's pose.
struct PoseEstimate {
  bool success = false;
  int matches = 0;
  int inliers = 0;
  Matrix6d covariance = Matrix6d::Identity();  ///< of the left perturbation of T_camera_world (m, rad)
};

/// Weight of a point that no other frame has confirmed yet, 0..1.
constexpr double kLeastTrust = 0.2;

/// How surely a landmark stands still by what was seen of it, kLeastTrust..1: somebody who stopped and walks on must
/// not outvote the room.
double trustOf(const Landmark& landmark);

/// A problem without observations yet.
PoseProblem startProblem(const TrackedFrame& frame, const SE3& T_camera_world, const FramePoseConfig& config);

/// @param trust  scales the observation's weight, 0..1
PoseObservation makeObservation(const Feature& feature, const Eigen::Vector3d& point_world, double trust);

PoseEstimate estimateFrom(const PoseSolution& solution, int matches);

/// Optimises current's pose on all its landmarks and drops the matches that do not fit.
PoseEstimate refinePose(const Map& map, const FramePoseConfig& config, TrackedFrame& current);

}  // namespace semantic_vslam
