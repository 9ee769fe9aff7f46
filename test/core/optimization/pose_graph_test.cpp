// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/optimization/pose_graph.h"

#include <gtest/gtest.h>

#include <atomic>

#include "core/optimization/relative_pose_cost.h"
#include "core/support/synthetic_map.h"
#include "numeric_jacobian.h"

namespace semantic_vslam {
namespace {

SE3 randomPose(Rng& rng, double translation_m, double rotation_rad) {
  Vector6d tangent;
  for (int i = 0; i < 3; ++i) tangent[i] = translation_m * rng.normal();
  for (int i = 3; i < 6; ++i) tangent[i] = rotation_rad * rng.normal();
  return se3Exp(tangent);
}

TEST(RelativePoseCost, JacobiansMatchNumericDifferences) {
  Rng rng(3);
  for (int trial = 0; trial < 5; ++trial) {
    const RelativePoseCost cost{randomPose(rng, 1.0, 0.5), randomPose(rng, 1.0, 0.5), randomPose(rng, 1.0, 0.5), 0.1,
                                0.02};
    Eigen::VectorXd x(12);
    for (int i = 0; i < 12; ++i) x[i] = trial == 0 ? 0.0 : 0.2 * rng.normal();
    Vector6d residual;
    Eigen::Matrix<double, 6, 6, Eigen::RowMajor> by_a, by_b;
    cost.evaluate(x.data(), x.data() + 6, residual.data(), by_a.data(), by_b.data());
    const Eigen::MatrixXd numeric = numericJacobian(
        [&cost](const Eigen::VectorXd& at) {
          Eigen::VectorXd r(6);
          cost.evaluate(at.data(), at.data() + 6, r.data(), nullptr, nullptr);
          return r;
        },
        x);
    EXPECT_LT(relativeDifference(by_a, numeric.leftCols(6)), 1e-7) << trial;
    EXPECT_LT(relativeDifference(by_b, numeric.rightCols(6)), 1e-7) << trial;
  }
}

TEST(RelativePoseCost, IsZeroWhereThePosesAgreeWithTheMeasurement) {
  Rng rng(4);
  const SE3 a = randomPose(rng, 1.0, 1.0), b = randomPose(rng, 1.0, 1.0);
  const RelativePoseCost cost{a, b, a * b.inverse(), 0.01, 0.01};
  const Vector6d zero = Vector6d::Zero();
  Vector6d residual;
  cost.evaluate(zero.data(), zero.data(), residual.data(), nullptr, nullptr);
  EXPECT_LT(residual.norm(), 1e-10);
}

/// A square round that drifts: true poses, and estimates made by chaining disturbed steps.
struct Ring {
  static constexpr int kNodes = 40;
  PoseGraphProblem problem;
  std::vector<SE3> truth;

  Ring() {
    Rng rng(5);
    for (int i = 0; i < kNodes; ++i) {
      const double angle = 2.0 * M_PI * i / kNodes;
      const Eigen::Quaterniond facing(Eigen::AngleAxisd(-angle, Eigen::Vector3d::UnitY()));
      truth.push_back(makeSE3(facing, {3.0 * std::cos(angle), 0.0, 3.0 * std::sin(angle)}).inverse());
    }
    SE3 estimate = truth[0];
    for (int i = 0; i < kNodes; ++i) {
      problem.nodes.push_back({KeyframeId(i), estimate, i == 0});
      if (i + 1 == kNodes) break;
      const SE3 step = randomPose(rng, 0.01, 0.003) * truth[i + 1] * truth[i].inverse();
      problem.edges.push_back({KeyframeId(i), KeyframeId(i + 1), step.inverse()});
      estimate = step * estimate;
    }
  }
  double error(const MapSolution& solution, int i) const {
    const auto moved = solution.T_camera_world.find(KeyframeId(i));
    const SE3& pose = moved == solution.T_camera_world.end() ? problem.nodes[i].T_camera_world : moved->second;
    return (pose.inverse().translation() - truth[i].inverse().translation()).norm();
  }
  double rmse(const MapSolution& solution) const {
    double sum = 0.0;
    for (int i = 0; i < kNodes; ++i) sum += error(solution, i) * error(solution, i);
    return std::sqrt(sum / kNodes);
  }
};

TEST(PoseGraph, ALoopEdgeSpreadsTheDriftOverTheRing) {
  Ring ring;
  const double before = ring.rmse({});
  ring.problem.edges.push_back(
      {KeyframeId(Ring::kNodes - 1), KeyframeId(0), ring.truth[Ring::kNodes - 1] * ring.truth[0].inverse()});
  const MapSolution solution = solve(ring.problem, {}, nullptr);
  EXPECT_EQ(solution.T_camera_world.size(), Ring::kNodes - 1U);
  EXPECT_LT(ring.rmse(solution), before);
  // All 40 edges are equally sure, so a fortieth of the gap stays at the loop's own edge.
  EXPECT_LT(ring.error(solution, Ring::kNodes - 1), 0.1 * ring.error({}, Ring::kNodes - 1));
}

TEST(PoseGraph, WithoutALoopNothingMoves) {
  const Ring ring;
  const MapSolution solution = solve(ring.problem, {}, nullptr);
  EXPECT_NEAR(ring.rmse(solution), ring.rmse({}), 1e-9);
}

TEST(PoseGraph, AbortLeavesThePosesWhereTheyWere) {
  Ring ring;
  ring.problem.edges.push_back({KeyframeId(Ring::kNodes - 1), KeyframeId(0), SE3::Identity()});
  const std::atomic<bool> abort{true};
  EXPECT_NEAR(ring.rmse(solve(ring.problem, {}, &abort)), ring.rmse({}), 1e-12);
}

TEST(PoseGraph, EssentialGraphHoldsTreeStrongCovisibilityAndLoops) {
  SyntheticWorld world(6);
  for (int i = 0; i < 800; ++i) {
    world.addPoint({world.rng().uniform(-2.0, 4.0), world.rng().uniform(-1.0, 1.0), world.rng().uniform(1.5, 3.0)});
  }
  SyntheticMap synthetic;
  for (int k = 0; k < 12; ++k) {
    SE3 T_world_camera = SE3::Identity();
    T_world_camera.translation().x() = 0.3 * k;
    addKeyframe(world, synthetic, T_world_camera.inverse(), T_world_camera.inverse(), {});
  }
  const Map& map = synthetic.map;
  PoseGraphConfig config;
  config.min_shared = 1000;  // nothing is that strong: the tree alone, one edge a keyframe but for the first
  EXPECT_EQ(selectEssentialGraph(map, {}, config).edges.size(), 11U);
  synthetic.map.addLoopEdge(KeyframeId(0), KeyframeId(11));
  EXPECT_EQ(selectEssentialGraph(map, {}, config).edges.size(), 12U);
  config.min_shared = 100;
  const PoseGraphProblem problem = selectEssentialGraph(map, {}, config);
  EXPECT_GT(problem.edges.size(), 12U);
  EXPECT_TRUE(problem.nodes.front().fixed);

  // A new measurement of the tied pair takes the place of the old one.
  const RelativePose loop{KeyframeId(11), KeyframeId(0), SE3::Identity()};
  const PoseGraphProblem with_loop = selectEssentialGraph(map, {loop}, config);
  EXPECT_EQ(with_loop.edges.size(), problem.edges.size());
  EXPECT_EQ(with_loop.edges.back().a, KeyframeId(11));
}

TEST(PoseGraph, NewKeyframesGoWithTheirParentAndLandmarksWithTheirReference) {
  SyntheticWorld world(7);
  for (int i = 0; i < 200; ++i) world.addPoint({world.rng().uniform(-1, 1), world.rng().uniform(-1, 1), 2.0});
  SyntheticMap synthetic;
  addKeyframe(world, synthetic, SE3::Identity(), SE3::Identity(), {});
  addKeyframe(world, synthetic, SE3::Identity(), SE3::Identity(), {});
  MapSolution solution;
  SE3 moved = SE3::Identity();
  moved.translation().x() = -0.5;  // camera at world x = 0.5
  solution.T_camera_world[KeyframeId(0)] = moved;
  carryAlong(synthetic.map, solution);
  ASSERT_EQ(solution.T_camera_world.count(KeyframeId(1)), 1U);  // whose parent is keyframe 0
  EXPECT_TRUE(solution.T_camera_world.at(KeyframeId(1)).isApprox(moved, 1e-12));
  ASSERT_FALSE(solution.position_world.empty());
  for (const auto& [id, position] : solution.position_world) {
    const Landmark& landmark = *synthetic.map.landmark(id);
    ASSERT_EQ(landmark.reference_keyframe, KeyframeId(0));
    EXPECT_LT((position - landmark.position_world - Eigen::Vector3d(0.5, 0, 0)).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace semantic_vslam
