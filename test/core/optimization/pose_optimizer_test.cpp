// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/optimization/pose_optimizer.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "core/common/rng.h"

namespace semantic_vslam {
namespace {

const CameraIntrinsics kIntrinsics{640, 480, 517.3, 516.5, 318.6, 255.3, {}};

const CameraModel& camera() {
  static const CameraModel model(kIntrinsics);
  return model;
}

struct Scene {
  PoseProblem problem;
  SE3 truth;
};

SE3 pose(double x, double y, double z, double rx, double ry, double rz) {
  Vector6d tangent;
  tangent << x, y, z, rx, ry, rz;
  return se3Exp(tangent);
}

/// Points in view of the true pose, with noise of one sigma, every second with depth; the first `outliers` are wrong.
Scene makeScene(int points, int outliers, double noise, std::uint64_t seed) {
  Rng rng(seed);
  Scene scene;
  scene.truth = pose(0.3, -0.1, 0.2, 0.1, 0.4, -0.2);
  scene.problem.camera = kIntrinsics;
  const VirtualStereo stereo(kIntrinsics, scene.problem.sensor.virtual_baseline_m);
  for (int i = 0; i < points; ++i) {
    const Eigen::Vector2d px(rng.uniform(10, 630), rng.uniform(10, 470));
    const double depth_m = rng.uniform(0.6, 5.0);
    PoseObservation o;
    o.point_world = scene.truth.inverse() * camera().unprojectUndistorted(px, depth_m);
    o.sigma_px = std::pow(1.2, static_cast<double>(rng.below(8)));
    o.undistorted_px = px + noise * o.sigma_px * Eigen::Vector2d(rng.normal(), rng.normal());
    if (i % 2 == 0) o.depth_m = stereo.fx_baseline / (stereo.fx_baseline / depth_m + 0.5 * noise * rng.normal());
    if (i < outliers) o.undistorted_px += Eigen::Vector2d(rng.uniform(20, 200), rng.uniform(20, 200));
    scene.problem.observations.push_back(o);
  }
  scene.problem.T_camera_world = pose(0.03, -0.02, 0.02, 0.02, -0.02, 0.01) * scene.truth;
  return scene;
}

double positionError(const SE3& a, const SE3& b) {
  return (a.inverse().translation() - b.inverse().translation()).norm();
}

TEST(PoseOptimizer, FindsTheExactPoseFromPerfectMatches) {
  const Scene scene = makeScene(50, 0, 0.0, 1);
  const PoseSolution solution = optimizePose(scene.problem, {});
  ASSERT_TRUE(solution.usable);
  EXPECT_EQ(solution.inliers, 50);
  EXPECT_LT(positionError(solution.T_camera_world, scene.truth), 1e-8);
  EXPECT_LT(rotationAngle(solution.T_camera_world * scene.truth.inverse()), 1e-8);
}

TEST(PoseOptimizer, RejectsThirtyPercentWrongMatchesAndKeepsTheTrueOnes) {
  const Scene scene = makeScene(400, 120, 1.0, 2);
  const PoseSolution solution = optimizePose(scene.problem, {});
  ASSERT_TRUE(solution.usable);
  EXPECT_LT(positionError(solution.T_camera_world, scene.truth), 0.008);
  int wrong_kept = 0, true_kept = 0;
  for (int i = 0; i < 400; ++i) (i < 120 ? wrong_kept : true_kept) += solution.inlier[i] ? 1 : 0;
  EXPECT_LE(wrong_kept, 2);
  EXPECT_GT(true_kept, 0.9 * 280);  // the test keeps 95 % of the true ones by its construction
  EXPECT_EQ(wrong_kept + true_kept, solution.inliers);
}

TEST(PoseOptimizer, WeightZeroTakesMovingPointsOutOfThePose) {
  Scene scene = makeScene(200, 0, 0.0, 3);
  // More than half of the points move together, as a person in front does.
  for (int i = 0; i < 120; ++i) {
    auto& o = scene.problem.observations[i];
    o.point_world += scene.truth.linear().transpose() * Eigen::Vector3d(0.06, 0.0, 0.0);
    o.weight = 0.0;
  }
  EXPECT_LT(positionError(optimizePose(scene.problem, {}).T_camera_world, scene.truth), 1e-6);
  for (auto& o : scene.problem.observations) o.weight = 1.0;
  EXPECT_GT(positionError(optimizePose(scene.problem, {}).T_camera_world, scene.truth), 0.02);
}

TEST(PoseOptimizer, FarDepthIsNotUsed) {
  Scene scene = makeScene(100, 0, 0.0, 4);
  for (auto& o : scene.problem.observations) {
    const double true_depth_m = (scene.truth * o.point_world).z();
    o.depth_m = true_depth_m > scene.problem.sensor.closeM() ? true_depth_m + 2.0 : 0.0;
  }
  const PoseSolution solution = optimizePose(scene.problem, {});
  EXPECT_EQ(solution.inliers, 100);
  EXPECT_LT(positionError(solution.T_camera_world, scene.truth), 1e-8);
}

TEST(PoseOptimizer, DepthTellsTheDistanceOfAPatchThatPixelsAloneHardlyTell) {
  // Matches on a spot of a tenth of the image: their scale says little about distance, their depth says it directly.
  Scene scene = makeScene(60, 0, 0.0, 5);
  Rng rng(5);
  for (auto& o : scene.problem.observations) {
    o.depth_m = rng.uniform(1.5, 2.5);
    o.undistorted_px = Eigen::Vector2d(320, 240) + 0.1 * (o.undistorted_px - Eigen::Vector2d(320, 240));
    o.point_world = scene.truth.inverse() * camera().unprojectUndistorted(o.undistorted_px, o.depth_m);
  }
  scene.problem.sensor.depth_noise.features_m = 0.1 / camera().fx() / scene.problem.sensor.virtual_baseline_m;
  const PoseSolution with_depth = optimizePose(scene.problem, {});
  for (auto& o : scene.problem.observations) o.depth_m = 0.0;
  const PoseSolution without = optimizePose(scene.problem, {});
  ASSERT_TRUE(with_depth.usable && without.usable);
  EXPECT_LT(positionError(with_depth.T_camera_world, scene.truth), 1e-4);
  // 60 depths of 2^2 / 41 m/px x 0.1 px x a mean level scale of 2: 2.5 mm in all; the pixels alone leave centimetres.
  EXPECT_LT(std::sqrt(with_depth.covariance(2, 2)), 0.004);
  EXPECT_GT(std::sqrt(without.covariance(2, 2)), 0.008);
}

TEST(PoseOptimizer, CovarianceMatchesTheScatterOfSolutions) {
  Eigen::Vector3d sum_squared = Eigen::Vector3d::Zero(), predicted = Eigen::Vector3d::Zero();
  constexpr int kTrials = 200;
  for (int trial = 0; trial < kTrials; ++trial) {
    Scene scene = makeScene(100, 0, 1.0, 100 + trial);
    scene.problem.sensor.depth_noise.features_m = 0.5 / camera().fx() / scene.problem.sensor.virtual_baseline_m;
    for (auto& o : scene.problem.observations) o.sigma_px = 1.0;
    Rng rng(900 + trial);
    for (auto& o : scene.problem.observations) {  // redraw the pixels with that one sigma
      const Eigen::Vector3d p = scene.truth * o.point_world;
      o.undistorted_px = camera().projectUndistorted(p) + Eigen::Vector2d(rng.normal(), rng.normal());
    }
    const PoseSolution solution = optimizePose(scene.problem, {});
    ASSERT_TRUE(solution.usable);
    const Eigen::Vector3d error = (solution.T_camera_world * scene.truth.inverse()).translation();
    sum_squared += error.cwiseAbs2() / kTrials;
    predicted += solution.covariance.diagonal().head<3>() / kTrials;
  }
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_GT(predicted[axis], 0.6 * sum_squared[axis]) << axis;
    EXPECT_LT(predicted[axis], 1.7 * sum_squared[axis]) << axis;
  }
}

TEST(PoseOptimizer, FewOrHopelessMatchesAreReportedUnusableAtTheStartPose) {
  for (const Scene& scene : {makeScene(0, 0, 0.0, 7), makeScene(9, 0, 0.0, 8), makeScene(40, 40, 0.0, 9)}) {
    const PoseSolution solution = optimizePose(scene.problem, {});
    EXPECT_FALSE(solution.usable);
    EXPECT_TRUE(solution.T_camera_world.isApprox(scene.problem.T_camera_world));
    EXPECT_EQ(solution.inlier.size(), scene.problem.observations.size());
  }
}

TEST(PoseOptimizer, PointsOnOneRayDoNotFixAPose) {
  Scene scene = makeScene(20, 0, 0.0, 10);
  for (int i = 0; i < 20; ++i) {
    auto& o = scene.problem.observations[i];
    o.undistorted_px = {kIntrinsics.cx, kIntrinsics.cy};
    o.depth_m = 0.0;
    o.point_world = scene.truth.inverse() * Eigen::Vector3d(0, 0, 1.0 + 0.1 * i);
  }
  scene.problem.T_camera_world = scene.truth;
  EXPECT_FALSE(optimizePose(scene.problem, {}).usable);
}

}  // namespace
}  // namespace semantic_vslam
