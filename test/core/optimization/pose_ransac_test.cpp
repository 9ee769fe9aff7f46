// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/optimization/pose_ransac.h"

#include <gtest/gtest.h>

#include "core/common/rng.h"

namespace semantic_vslam {
namespace {

const CameraIntrinsics kIntrinsics{640, 480, 517.3, 516.5, 318.6, 255.3, {}};

/// Matches with pixel noise of half a sigma, of which the first `wrong` are anything; depth on every second.
PoseProblem makeProblem(int count, int wrong, const SE3& truth, std::uint64_t seed) {
  Rng rng(seed);
  PoseProblem problem;
  problem.camera = kIntrinsics;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector2d px(rng.uniform(0, 640), rng.uniform(0, 480));
    const double depth_m = rng.uniform(0.8, 3.0);
    const Eigen::Vector3d in_camera((px.x() - kIntrinsics.cx) / kIntrinsics.fx * depth_m,
                                    (px.y() - kIntrinsics.cy) / kIntrinsics.fy * depth_m, depth_m);
    PoseObservation o;
    o.point_world = truth.inverse() * in_camera;
    o.undistorted_px = px + 0.5 * Eigen::Vector2d(rng.normal(), rng.normal());
    if (i % 2 == 0) o.depth_m = depth_m;
    if (i < wrong) o.undistorted_px = {rng.uniform(0, 640), rng.uniform(0, 480)};
    problem.observations.push_back(o);
  }
  return problem;
}

SE3 truePose() {
  Vector6d tangent;
  tangent << 0.5, -0.3, 0.8, 0.4, -0.9, 0.3;
  return se3Exp(tangent);
}

TEST(PoseRansac, FindsThePoseAmongSixtyPercentWrongMatches) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const PoseProblem problem = makeProblem(100, 60, truePose(), seed);
    const auto pose = findPose(problem, {});
    ASSERT_TRUE(pose) << seed;
    const SE3 difference = *pose * truePose().inverse();
    EXPECT_LT(difference.translation().norm(), 0.05) << seed;
    EXPECT_LT(rotationAngle(difference), 0.02) << seed;
  }
}

TEST(PoseRansac, RandomMatchesHaveNoPose) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    EXPECT_FALSE(findPose(makeProblem(100, 100, truePose(), seed), {})) << seed;
  }
}

TEST(PoseRansac, TooFewMatchesHaveNoPose) {
  EXPECT_FALSE(findPose(makeProblem(0, 0, truePose(), 1), {}));
  EXPECT_FALSE(findPose(makeProblem(11, 0, truePose(), 1), {}));
}

TEST(PoseRansac, SameProblemGivesTheSameBits) {
  const PoseProblem problem = makeProblem(80, 40, truePose(), 5);
  EXPECT_EQ(findPose(problem, {})->matrix(), findPose(problem, {})->matrix());
}

}  // namespace
}  // namespace semantic_vslam
