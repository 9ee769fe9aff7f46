// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/optimization/pose_cost.h"
#include "semantic_vslam/core/camera/camera_model.h"
#include "semantic_vslam/core/camera/sensor_config.h"
#include "semantic_vslam/core/geometry/se3.h"
#include "semantic_vslam/core/optimization/optimization_config.h"

namespace semantic_vslam {

/// One match of a frame's feature with a point of the world.
struct PoseObservation {
  Eigen::Vector3d point_world = Eigen::Vector3d::Zero();  ///< metres
  Eigen::Vector2d undistorted_px = Eigen::Vector2d::Zero();
  double depth_m = 0.0;   ///< 0 = none
  double sigma_px = 1.0;  ///< scale of the feature's pyramid level, 1.2^octave
  double weight = 1.0;    ///< how surely it is static, 0..1
};

struct PoseProblem {
  SE3 T_camera_world = SE3::Identity();  ///< start
  CameraIntrinsics camera;               ///< distortion is not used: pixels are undistorted
  SensorConfig sensor;                   ///< how depth is weighed
  std::vector<PoseObservation> observations;
};

struct PoseSolution {
  SE3 T_camera_world = SE3::Identity();
  std::vector<bool> inlier;  ///< per observation
  int inliers = 0;
  Matrix6d covariance = Matrix6d::Identity();  ///< of the left perturbation (m, rad), from the inliers
  bool usable = false;  ///< false: too few inliers or not all six degrees of freedom fixed; the pose is then the start
};

/// Pose of one camera from matches with fixed points: reprojection error with Huber's kernel, several rounds, between
/// which matches are judged anew by the chi-square test (95 %: 5.991 for a pixel, 7.815 with depth), as published for
/// ORB-SLAM2 ("motion-only bundle adjustment", section III.C). A match can come back in a later round. Observations of
/// weight 0 have no influence but are judged like all others.
/// @param config  valid (its owner has validated it)
PoseSolution optimizePose(const PoseProblem& problem, const PoseOptimizerConfig& config);

}  // namespace semantic_vslam
