// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/optimization/pose_ransac.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <vector>

#include "core/common/rng.h"

namespace semantic_vslam {
namespace {

constexpr int kSample = 3;
constexpr double kConfidence = 0.999;
constexpr std::uint64_t kSeed = 1;

std::array<int, kSample> drawSample(Rng& rng, int count) {
  std::array<int, kSample> sample{};
  for (int i = 0; i < kSample; ++i) {
    do {
      sample[i] = static_cast<int>(rng.below(static_cast<std::uint64_t>(count)));
    } while (std::find(sample.begin(), sample.begin() + i, sample[i]) != sample.begin() + i);
  }
  return sample;
}

/// The up to four poses from which three points are seen where they are.
std::vector<SE3> solveSample(const PoseProblem& problem, const std::array<int, kSample>& sample) {
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> rays;
  for (const int i : sample) {
    const PoseObservation& o = problem.observations[i];
    points.emplace_back(o.point_world.x(), o.point_world.y(), o.point_world.z());
    rays.emplace_back((o.undistorted_px.x() - problem.camera.cx) / problem.camera.fx,
                      (o.undistorted_px.y() - problem.camera.cy) / problem.camera.fy);
  }
  std::vector<cv::Mat> rotations, translations;
  cv::solveP3P(points, rays, cv::Matx33d::eye(), cv::noArray(), rotations, translations, cv::SOLVEPNP_AP3P);
  std::vector<SE3> poses;
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    SE3 pose = SE3::Identity();
    pose.linear() = so3Exp(Eigen::Vector3d(rotations[i].ptr<double>()));
    pose.translation() = Eigen::Vector3d(translations[i].ptr<double>());
    if (pose.matrix().allFinite()) poses.push_back(pose);
  }
  return poses;
}

/// Samples after which one without a wrong match was drawn with kConfidence.
double samplesNeeded(double inlier_share) {
  const double clean = std::pow(inlier_share, kSample);
  if (clean >= 1.0) return 1.0;
  return std::log(1.0 - kConfidence) / std::log1p(-clean);
}

}  // namespace

std::optional<SE3> findPose(const PoseProblem& problem, const PoseRansacConfig& config) {
  const int count = static_cast<int>(problem.observations.size());
  if (count < std::max(kSample, config.min_inliers)) return std::nullopt;
  const VirtualStereo camera(problem.camera, problem.sensor.virtual_baseline_m);
  std::vector<PixelMeasurement> measurements;
  for (const auto& o : problem.observations) {
    measurements.push_back(
        makeMeasurement(o.undistorted_px, o.depth_m, config.tolerance * o.sigma_px, o.weight, camera, problem.sensor));
  }
  const auto countInliers = [&](const SE3& pose) {
    int inliers = 0;
    for (int i = 0; i < count; ++i) {
      inliers += fits(camera, measurements[i], pose * problem.observations[i].point_world) ? 1 : 0;
    }
    return inliers;
  };

  Rng rng(kSeed);
  SE3 best = SE3::Identity();
  int best_inliers = 0;
  double needed = config.iterations;
  for (int i = 0; i < config.iterations && i < needed; ++i) {
    for (const SE3& pose : solveSample(problem, drawSample(rng, count))) {
      const int inliers = countInliers(pose);
      if (inliers <= best_inliers) continue;
      best = pose;
      best_inliers = inliers;
      needed = samplesNeeded(static_cast<double>(inliers) / count);
    }
  }
  if (best_inliers < config.min_inliers) return std::nullopt;
  return best;
}

}  // namespace semantic_vslam
