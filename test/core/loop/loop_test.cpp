// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "core/loop/loop_corrector.h"
#include "core/loop/loop_detector.h"
#include "core/mapping/ba_selection.h"
#include "core/optimization/bundle_adjustment.h"
#include "core/support/synthetic_map.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

constexpr double kBaselineM = 0.08;

/// Pose on a round of radius 3 m through a hall, looking outwards.
SE3 onRound(double turns) {
  const double angle = 2.0 * M_PI * turns;
  const Eigen::Quaterniond heading(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()));
  return makeSE3(heading, {3.0 * std::sin(angle), 0.0, 3.0 * std::cos(angle)}).inverse();
}

/// Walks and maps with drift; landmarks that went out of view are not matched again by tracking.
class Walk {
 public:
  explicit Walk(std::uint64_t seed) : world(seed), rng_(seed + 1000) {}

  /// @return the loop that the detector reports at this keyframe
  std::optional<LoopClosure> stepTo(const SE3& truth, LoopDetector& detector, double drift_m = 0.008) {
    SE3 estimate = truth;
    if (!synthetic.true_T_camera_world.empty()) {
      const SE3 step = truth * synthetic.true_T_camera_world.back().inverse();
      Vector6d error;
      for (int i = 0; i < 3; ++i) error[i] = drift_m * (0.5 * rng_.normal() + (i == 0 ? 0.7 : 0.0));
      for (int i = 3; i < 6; ++i) error[i] = 0.25 * drift_m * rng_.normal();
      estimate = se3Exp(error) * step * map().keyframes().rbegin()->second.T_camera_world;
    }
    const KeyframeId id = addKeyframe(world, synthetic, truth, estimate, {}, 10);
    const auto closure = detector.detect(map(), index, id);
    index.add(id, *map().keyframe(id)->features);
    return closure;
  }
  double errorOf(KeyframeId id) const {
    return (synthetic.map.keyframe(id)->T_camera_world.inverse().translation() -
            synthetic.true_T_camera_world[id.value()].inverse().translation())
        .norm();
  }
  double rmse() const {
    double sum = 0.0;
    for (const auto& [id, keyframe] : synthetic.map.keyframes()) {
      sum += errorOf(id) * errorOf(id);
    }
    return std::sqrt(sum / static_cast<double>(synthetic.map.keyframes().size()));
  }
  Map& map() { return synthetic.map; }

  SyntheticWorld world;
  SyntheticMap synthetic;
  PlaceIndex index;

 private:
  Rng rng_;
};

constexpr int kPerTurn = 60;

/// Walks on until a loop is reported, at most 1.3 turns.
std::optional<LoopClosure> walkRound(Walk& walk, LoopDetector& detector, int* keyframes = nullptr) {
  walk.world.addRoom({0, 0, 0}, {12, 3, 12}, 6000);
  for (int k = 0; k < kPerTurn * 13 / 10; ++k) {
    if (keyframes != nullptr) *keyframes = k;
    if (auto closure = walk.stepTo(onRound(static_cast<double>(k) / kPerTurn), detector)) return closure;
  }
  return std::nullopt;
}

TEST(LoopDetector, FindsTheLoopSoonAfterTheStartIsSeenAgainAndNotBefore) {
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    Walk walk(seed);
    LoopDetector detector({}, {});
    int keyframes = 0;
    const auto closure = walkRound(walk, detector, &keyframes);
    ASSERT_TRUE(closure) << seed;
    EXPECT_GT(keyframes, kPerTurn * 8 / 10) << seed;  // the view is 63 degrees wide
    EXPECT_LT(keyframes, kPerTurn * 12 / 10) << seed;
    const SE3& truth = walk.synthetic.true_T_camera_world[closure->current.value()];
    // The old landmarks are nearly true, so the corrected pose is.
    EXPECT_LT((closure->T_current_world.inverse().translation() - truth.inverse().translation()).norm(), 0.15) << seed;
  }
}

TEST(LoopCorrector, ClosingTakesMostOfTheErrorOutAndJoinsBothVisits) {
  Walk walk(3);
  LoopDetector detector({}, {});
  const auto closure = walkRound(walk, detector);
  ASSERT_TRUE(closure);
  Map& map = walk.map();
  const double before = walk.rmse(), end_before = walk.errorOf(closure->current);
  const std::size_t landmarks_before = map.landmarks().size();
  const std::uint64_t version = map.version();

  const LoopCorrectorConfig config;
  const PoseGraphProblem graph = selectLoop(map, *closure, config);
  ASSERT_TRUE(applyLoop(map, *closure, solve(graph, config.graph, nullptr), graph.map_version, kBaselineM, config));
  const double closed = walk.rmse();
  EXPECT_LT(walk.errorOf(closure->current), end_before / 3.0);
  EXPECT_LT(closed, before);
  EXPECT_GT(map.version(), version);
  EXPECT_LT(map.landmarks().size() + 100, landmarks_before);
  EXPECT_EQ(map.keyframe(closure->current)->loop_edges, std::vector<KeyframeId>{closure->matched});
  bool connected = false;
  for (const auto& [id, shared] : map.covisible(closure->current, 50))
    connected |= id == closure->matched && shared > 0;
  EXPECT_TRUE(connected);

  const BaProblem bundle = selectGlobal(map, SensorConfig());
  ASSERT_TRUE(map.apply(solve(bundle, {}, nullptr), bundle.map_version));
  std::printf("loop: rmse %.3f m -> pose graph %.3f m -> global adjustment %.3f m\n", before, closed, walk.rmse());
  EXPECT_LT(walk.rmse(), before / 3.0);
  EXPECT_LT(walk.rmse(), 0.03);
}

TEST(LoopCorrector, KeyframesMadeMeanwhileComeAlongAndStaleGraphsAreRefused) {
  Walk walk(3);
  LoopDetector detector({}, {});
  const auto closure = walkRound(walk, detector);
  ASSERT_TRUE(closure);
  Map& map = walk.map();
  const LoopCorrectorConfig config;
  const PoseGraphProblem graph = selectLoop(map, *closure, config);
  const MapSolution solution = solve(graph, config.graph, nullptr);
  detector.reset();
  const KeyframeId before = closure->current;
  walk.stepTo(onRound((before.value() + 1.0) / kPerTurn), detector);
  const KeyframeId newest = map.keyframes().rbegin()->first;
  const KeyframeId parent = map.keyframe(newest)->parent;
  const SE3 relative = map.keyframe(newest)->T_camera_world * map.keyframe(parent)->T_camera_world.inverse();

  EXPECT_FALSE(applyLoop(map, *closure, solution, graph.map_version + 1, kBaselineM, config));
  EXPECT_TRUE(map.keyframe(before)->loop_edges.empty());
  ASSERT_TRUE(applyLoop(map, *closure, solution, graph.map_version, kBaselineM, config));
  const SE3 after = map.keyframe(newest)->T_camera_world * map.keyframe(parent)->T_camera_world.inverse();
  EXPECT_TRUE(after.isApprox(relative, 1e-9));
}

TEST(LoopDetector, ARoomThatLooksTheSameIsNoLoopBecauseNoDriftIsThatLarge) {
  const auto walkTwoRooms = [](const LoopDetectorConfig& config) {
    Walk walk(9);
    walk.world.addRoom({0, 0, 0}, {5, 3, 5}, 2500);
    walk.world.addCopy({0, 0, 9});
    LoopDetector detector(config, {});
    // Turns round in the first room, walks on, turns round in the second.
    for (int k = 0; k < 70; ++k) {
      const double z = k < 24 ? 0.0 : k < 46 ? 9.0 * (k - 24) / 22.0 : 9.0;
      const double heading = k < 24 ? 2.0 * M_PI * k / 24 : k < 46 ? 0.0 : 2.0 * M_PI * (k - 46) / 24;
      const SE3 pose =
          makeSE3(Eigen::Quaterniond(Eigen::AngleAxisd(heading, Eigen::Vector3d::UnitY())), {0, 0, z}).inverse();
      if (auto closure = walk.stepTo(pose, detector, 0.003)) {
        const double truly_apart =
            (walk.synthetic.true_T_camera_world[closure->current.value()].inverse().translation() -
             walk.synthetic.true_T_camera_world[closure->matched.value()].inverse().translation())
                .norm();
        if (truly_apart > 4.0) return true;
      }
    }
    return false;
  };
  EXPECT_FALSE(walkTwoRooms({}));
  LoopDetectorConfig careless;
  careless.max_drift_share = 1.0;
  careless.max_drift_base_m = 10.0;
  careless.max_drift_base_rad = 3.2;
  EXPECT_TRUE(walkTwoRooms(careless));  // appearance and geometry alone cannot tell the rooms apart
}

/// A camera that pans 40 degrees aside and back, always with part of the first view in sight. On the way back the map
/// puts it off by some way, as when people covered most of the view.
class PanAside {
 public:
  PanAside() { world_.addRoom({0, 0, 0}, {6, 3, 6}, 3000); }

  /// @param found_share  of the landmarks in view, of the keyframes half way
  std::optional<LoopClosure> run(LoopDetector& detector, double off_m, double found_share) {
    constexpr int kHalf = 10;
    for (int k = 0; k < 2 * kHalf; ++k) {
      const double heading = 0.07 * (k < kHalf ? k : 2 * kHalf - 1 - k);
      const SE3 truth =
          makeSE3(Eigen::Quaterniond(Eigen::AngleAxisd(heading, Eigen::Vector3d::UnitY())), {0.01 * k, 0, 0}).inverse();
      const SE3 off(Eigen::Translation3d(k < kHalf ? 0.0 : off_m, 0.0, 0.0));
      const KeyframeId id = addKeyframe(world_, synthetic_, truth, truth * off, {}, 3);
      detector.noteKeyframe(id, k == kHalf ? found_share : 0.5);
      const auto closure = detector.detect(synthetic_.map, index_, id);
      if (closure) return closure;
      index_.add(id, *synthetic_.map.keyframe(id)->features);
    }
    return std::nullopt;
  }
  double errorOf(const LoopClosure& closure) const {
    return (closure.T_current_world.inverse().translation() -
            synthetic_.true_T_camera_world[closure.current.value()].inverse().translation())
        .norm();
  }
  const Map& map() const { return synthetic_.map; }

 private:
  SyntheticWorld world_{4};
  SyntheticMap synthetic_;
  PlaceIndex index_;
};

TEST(LoopDetector, AfterAnUnsureKeyframeTheOlderMapIsLookedForThoughTrackingConnectsIt) {
  PanAside pan;
  LoopDetector detector({}, {});
  const auto closure = pan.run(detector, 0.08, 0.1);
  ASSERT_TRUE(closure);
  EXPECT_LT(closure->matched.value(), 10U);
  EXPECT_GE(closure->current.value(), 10U);
  EXPECT_LT(pan.errorOf(*closure), 0.02);
}

TEST(LoopDetector, ASureMapAndOneThatFitsAreLeftAlone) {
  LoopDetector sure({}, {}), fits({}, {});
  EXPECT_FALSE(PanAside().run(sure, 0.08, 0.5));
  EXPECT_FALSE(PanAside().run(fits, 0.01, 0.1));
}

TEST(LoopDetector, RefusesAConfigOutOfRange) {
  LoopDetectorConfig config;
  config.consistent_keyframes = 0;
  EXPECT_THROW(LoopDetector(config, {}), ConfigError);
}

}  // namespace
}  // namespace semantic_vslam
