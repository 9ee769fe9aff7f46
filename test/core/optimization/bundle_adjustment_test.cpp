// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/optimization/bundle_adjustment.h"

#include <gtest/gtest.h>

#include <atomic>
#include <set>

#include "core/mapping/ba_selection.h"
#include "core/support/synthetic_map.h"

namespace semantic_vslam {
namespace {

constexpr int kFixed = 3;

SE3 perturbed(const SE3& pose, Rng& rng, double translation_m, double rotation_rad) {
  Vector6d tangent;
  for (int i = 0; i < 3; ++i) tangent[i] = translation_m * rng.normal();
  for (int i = 3; i < 6; ++i) tangent[i] = rotation_rad * rng.normal();
  return se3Exp(tangent) * pose;
}

/// A camera that moves sideways in front of a wall of points; all but the first keyframes have wrong poses.
struct WallMap {
  explicit WallMap(int keyframes, int points, const SyntheticWorld::Noise& noise, double translation_m = 0.02)
      : world(17) {
    for (int i = 0; i < points; ++i) {
      world.addPoint({world.rng().uniform(-2.0, 3.0), world.rng().uniform(-1.2, 1.2), world.rng().uniform(1.2, 3.0)});
    }
    for (int k = 0; k < keyframes; ++k) {
      SE3 T_world_camera = SE3::Identity();
      T_world_camera.translation() = Eigen::Vector3d(0.08 * k, 0.02 * (k % 3), 0.0);
      const SE3 truth = T_world_camera.inverse();
      const SE3 estimate = k < kFixed ? truth : perturbed(truth, world.rng(), translation_m, 0.5 * translation_m);
      addKeyframe(world, synthetic, truth, estimate, noise);
    }
  }
  double poseError(const Map& map) const {
    double sum = 0.0;
    for (const auto& [id, keyframe] : map.keyframes()) {
      const SE3 difference = keyframe.T_camera_world * synthetic.true_T_camera_world[id.value()].inverse();
      sum += difference.translation().squaredNorm();
    }
    return std::sqrt(sum / static_cast<double>(map.keyframes().size()));
  }
  SyntheticWorld world;
  SyntheticMap synthetic;
};

TEST(BundleAdjustment, PerfectMeasurementsGiveTheTruthBack) {
  WallMap scene(6, 400, {0.0, 0.0, 0});
  BaConfig config;
  config.first_iterations = config.second_iterations = 30;
  ASSERT_GT(scene.poseError(scene.synthetic.map), 0.01);
  const MapSolution solution = solve(selectGlobal(scene.synthetic.map, SensorConfig()), config, nullptr);
  ASSERT_TRUE(scene.synthetic.map.apply(solution, scene.synthetic.map.version()));
  EXPECT_LT(scene.poseError(scene.synthetic.map), 5e-4);
}

TEST(BundleAdjustment, NoiseAndWrongMatchesAreAveragedAndTakenOut) {
  WallMap scene(8, 600, {0.5, 0.3, 0});
  Map& map = scene.synthetic.map;
  // Swap the landmarks of some features in keyframe 5: wrong matches.
  const std::vector<LandmarkId> matches = map.keyframe(KeyframeId(5))->landmarks;
  std::set<std::pair<std::uint64_t, std::uint64_t>> wrong;
  for (std::size_t i = 0; i + 1 < 40; i += 2) {
    if (!matches[i].valid() || !matches[i + 1].valid()) continue;
    map.removeObservation(KeyframeId(5), matches[i]);
    map.removeObservation(KeyframeId(5), matches[i + 1]);
    if (map.addObservation(KeyframeId(5), static_cast<int>(i), matches[i + 1]))
      wrong.insert({5, matches[i + 1].value()});
    if (map.addObservation(KeyframeId(5), static_cast<int>(i + 1), matches[i])) wrong.insert({5, matches[i].value()});
  }
  ASSERT_GT(wrong.size(), 20U);
  const double before = scene.poseError(map);
  const MapSolution solution = solve(selectGlobal(map, SensorConfig()), {}, nullptr);
  std::size_t found = 0;
  for (const auto& [keyframe, landmark] : solution.outlier_observations) {
    found += wrong.count({keyframe.value(), landmark.value()});
  }
  EXPECT_GE(found, wrong.size() * 9 / 10);
  EXPECT_LT(solution.outlier_observations.size(), wrong.size() + 60);
  ASSERT_TRUE(map.apply(solution, map.version()));
  EXPECT_LT(scene.poseError(map), 0.2 * before);
  EXPECT_LT(scene.poseError(map), 0.004);
}

TEST(BundleAdjustment, LocalSelectionTakesNeighboursFixesTheRingAndTheFirst) {
  WallMap scene(30, 900, {0.5, 0.3, 0}, 0.0);
  BaConfig config;
  config.max_keyframes = 5;
  config.max_fixed_keyframes = 4;
  const BaProblem problem = selectLocal(scene.synthetic.map, KeyframeId(20), SensorConfig(), config);
  std::set<KeyframeId> free, fixed;
  for (const auto& keyframe : problem.keyframes) (keyframe.fixed ? fixed : free).insert(keyframe.id);
  EXPECT_EQ(free.size(), 5U);
  EXPECT_EQ(fixed.size(), 4U);
  EXPECT_EQ(free.count(KeyframeId(20)), 1U);
  EXPECT_TRUE(free.count(KeyframeId(19)) + free.count(KeyframeId(21)) >= 1U);
  for (const auto& o : problem.observations) {
    ASSERT_LT(o.keyframe, 9);
    ASSERT_LT(o.landmark, static_cast<int>(problem.landmarks.size()));
  }

  const BaProblem at_start = selectLocal(scene.synthetic.map, KeyframeId(1), SensorConfig(), config);
  for (const auto& keyframe : at_start.keyframes) {
    if (keyframe.id == KeyframeId(0)) {
      EXPECT_TRUE(keyframe.fixed);
    }
  }
  EXPECT_TRUE(selectLocal(scene.synthetic.map, KeyframeId(99), SensorConfig(), config).keyframes.empty());
}

TEST(BundleAdjustment, SmallMapWithoutARingStillHasOneFixedKeyframe) {
  WallMap scene(3, 300, {0.5, 0.3, 0}, 0.0);
  int fixed = 0;
  for (const auto& keyframe : selectLocal(scene.synthetic.map, KeyframeId(2), SensorConfig(), {}).keyframes)
    fixed += keyframe.fixed;
  EXPECT_EQ(fixed, 1);
}

TEST(BundleAdjustment, FixedKeyframesKeepTheirPoseAndFarOnesAreNotMentioned) {
  WallMap scene(30, 900, {0.5, 0.3, 0});
  BaConfig config;
  config.max_keyframes = 5;
  const BaProblem problem = selectLocal(scene.synthetic.map, KeyframeId(20), SensorConfig(), config);
  const MapSolution solution = solve(problem, config, nullptr);
  EXPECT_EQ(solution.T_camera_world.size(), 5U);
  for (const auto& keyframe : problem.keyframes) {
    EXPECT_EQ(solution.T_camera_world.count(keyframe.id), keyframe.fixed ? 0U : 1U);
  }
}

TEST(BundleAdjustment, LandmarkSeenOnceGoesAlongWithItsKeyframe) {
  WallMap scene(6, 400, {0.0, 0.0, 0});
  Map& map = scene.synthetic.map;
  // Cut all but the last sighting of one landmark.
  const KeyframeId last(5);
  LandmarkId lonely;
  for (const LandmarkId id : map.keyframe(last)->landmarks) {
    if (id.valid()) lonely = id;
  }
  for (int k = 0; k < 5; ++k) map.removeObservation(KeyframeId(k), lonely);
  ASSERT_EQ(map.landmark(lonely)->observations.size(), 1U);
  const Eigen::Vector3d in_camera = map.keyframe(last)->T_camera_world * map.landmark(lonely)->position_world;
  ASSERT_TRUE(map.apply(solve(selectGlobal(map, SensorConfig()), {}, nullptr), map.version()));
  EXPECT_LT((map.keyframe(last)->T_camera_world * map.landmark(lonely)->position_world - in_camera).norm(), 1e-9);
}

TEST(BundleAdjustment, AbortReturnsAtOnceAndRemovesNothing) {
  WallMap scene(8, 600, {0.5, 0.3, 0});
  const std::atomic<bool> abort{true};
  const MapSolution solution = solve(selectGlobal(scene.synthetic.map, SensorConfig()), {}, &abort);
  EXPECT_TRUE(solution.outlier_observations.empty());
  for (const auto& [id, pose] : solution.T_camera_world) {
    EXPECT_TRUE(pose.isApprox(scene.synthetic.map.keyframe(id)->T_camera_world, 1e-12));
  }
}

TEST(BundleAdjustment, StaleSolutionIsRefused) {
  WallMap scene(4, 300, {0.5, 0.3, 0});
  Map& map = scene.synthetic.map;
  const BaProblem problem = selectGlobal(map, SensorConfig());
  const MapSolution solution = solve(problem, {}, nullptr);
  map.bumpVersion();
  EXPECT_FALSE(map.apply(solution, problem.map_version));
}

TEST(BundleAdjustment, SameProblemGivesTheSameBits) {
  WallMap scene(6, 400, {0.5, 0.3, 0});
  const BaProblem problem = selectLocal(scene.synthetic.map, KeyframeId(5), SensorConfig(), {});
  const MapSolution a = solve(problem, {}, nullptr), b = solve(problem, {}, nullptr);
  for (const auto& [id, pose] : a.T_camera_world) EXPECT_EQ(pose.matrix(), b.T_camera_world.at(id).matrix());
  for (const auto& [id, position] : a.position_world) EXPECT_EQ(position, b.position_world.at(id));
  EXPECT_EQ(a.outlier_observations, b.outlier_observations);
}

}  // namespace
}  // namespace semantic_vslam
