// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/optimization/frame_pose.h"

#include <algorithm>
#include <vector>

namespace semantic_vslam {
namespace {

// What has stood still for a second is worth more than what was seen for the first time. A new point keeps a fifth of
// its weight, since on new ground there is nothing else.
constexpr double kTrustedSightings = 30.0;

}  // namespace

double trustOf(const Landmark& landmark) {
  return std::clamp(landmark.found_count / kTrustedSightings, kLeastTrust, 1.0);
}

PoseProblem startProblem(const TrackedFrame& frame, const SE3& T_camera_world, const FramePoseConfig& config) {
  PoseProblem problem;
  problem.T_camera_world = T_camera_world;
  problem.camera = frame.camera->intrinsics();
  problem.sensor = config.sensor;
  return problem;
}

PoseObservation makeObservation(const Feature& feature, const Eigen::Vector3d& point_world, double trust) {
  PoseObservation observation;
  observation.point_world = point_world;
  observation.undistorted_px = feature.undistorted_px.cast<double>();
  observation.depth_m = feature.depth_m;
  observation.sigma_px = pyramidScale(feature.octave);
  observation.weight = feature.static_weight * trust;
  return observation;
}

PoseEstimate estimateFrom(const PoseSolution& solution, int matches) {
  PoseEstimate estimate;
  estimate.success = solution.usable;
  estimate.matches = matches;
  estimate.inliers = solution.inliers;
  estimate.covariance = solution.covariance;
  return estimate;
}

PoseEstimate refinePose(const Map& map, const FramePoseConfig& config, TrackedFrame& current) {
  PoseProblem problem = startProblem(current, current.T_camera_world, config);
  std::vector<int> matched;
  for (int i = 0; i < static_cast<int>(current.landmarks.size()); ++i) {
    const Landmark* landmark = map.landmark(current.landmarks[i]);
    if (!landmark) {
      current.landmarks[i] = LandmarkId();
      continue;
    }
    matched.push_back(i);
    problem.observations.push_back(makeObservation(current.feature(i), landmark->position_world, trustOf(*landmark)));
  }
  const PoseSolution solution = optimizePose(problem, config.pose);
  if (solution.usable) {
    current.T_camera_world = solution.T_camera_world;
    for (std::size_t i = 0; i < matched.size(); ++i) {
      if (!solution.inlier[i]) current.landmarks[matched[i]] = LandmarkId();
    }
  }
  return estimateFrom(solution, static_cast<int>(matched.size()));
}

}  // namespace semantic_vslam
