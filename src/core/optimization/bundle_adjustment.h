// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/common/abort_flag.h"
#include "core/map/map.h"
#include "semantic_vslam/core/camera/camera_model.h"
#include "semantic_vslam/core/camera/sensor_config.h"
#include "semantic_vslam/core/geometry/se3.h"
#include "semantic_vslam/core/optimization/optimization_config.h"

namespace semantic_vslam {

struct BaKeyframe {
  KeyframeId id;
  SE3 T_camera_world = SE3::Identity();
  CameraIntrinsics camera;
  bool fixed = false;
};

struct BaLandmark {
  LandmarkId id;
  Eigen::Vector3d position_world = Eigen::Vector3d::Zero();  ///< metres
};

struct BaObservation {
  int keyframe = 0;  ///< index into BaProblem::keyframes
  int landmark = 0;  ///< index into BaProblem::landmarks
  Eigen::Vector2d undistorted_px = Eigen::Vector2d::Zero();
  double depth_m = 0.0;   ///< 0 = none
  double sigma_px = 1.0;  ///< scale of the feature's pyramid level
  double weight = 1.0;    ///< how surely it is static, 0..1
};

/// Copy of the part of a map that is adjusted; it can be solved while the map lives on.
struct BaProblem {
  std::uint64_t map_version = 0;  ///< for Map::apply
  SensorConfig sensor;            ///< how depth is weighed
  std::vector<BaKeyframe> keyframes;
  std::vector<BaLandmark> landmarks;
  std::vector<BaObservation> observations;
};

/// Bundle adjustment: poses and landmarks that minimise the reprojection error (ORB-SLAM2, section III.C, eq. 2 and 3,
/// with depth as virtual disparity), Huber's kernel, a second round without the matches that fail the chi-square test.
/// Landmarks seen once go along with their keyframe.
/// @param config  valid (its owner has validated it)
/// @param abort   looked at between steps; may be nullptr. What was reached till then is the solution.
/// @return values of the free keyframes and of all landmarks, and the matches found to be wrong.
MapSolution solve(const BaProblem& problem, const BaConfig& config, const AbortFlag* abort);

}  // namespace semantic_vslam
