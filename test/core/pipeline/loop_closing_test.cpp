// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/pipeline/sparse_slam.h"
#include "core/support/motion_alone.h"
#include "eval/scenario_source.h"
#include "eval/trajectory_error.h"
#include "semantic_vslam/core/pipeline/pipeline.h"

namespace semantic_vslam {
namespace {

/// One and a fifth turns through an office on a round of 0.6 m radius, looking outwards: what was behind the camera
/// a quarter of a minute ago comes into view again, and tracking does not know that it has been there.
Scenario turnInARoom(std::uint64_t seed) {
  constexpr int kKnotsPerTurn = 24;
  Scenario scenario = makeScenario("static", seed);
  scenario.fps = 8.0;
  auto& camera = scenario.camera;
  camera.knot_interval_s = 0.65;
  camera.knots.clear();
  for (int i = 0; i <= kKnotsPerTurn * 6 / 5; ++i) {
    const double angle = 2.0 * M_PI * i / kKnotsPerTurn;
    camera.knots.push_back({{0.6 * std::cos(angle), 0.6 * std::sin(angle), 1.3}, angle, -0.1});
  }
  scenario.duration_s = camera.knot_interval_s * static_cast<double>(camera.knots.size() - 1);
  return scenario;
}

struct Outcome {
  std::size_t frames = 0, posed = 0;
  std::vector<ClosedLoop> loops;
  double ate_before_m = 0.0;  ///< over the frames up to the first loop, just before it is closed
  double ate_m = 0.0;
};

Outcome run(FrameSource& source) {
  SystemConfig config = motionAlone();
  config.dense.enabled = false;
  config.slam.tracking.orb.features = 400;  // little texture: enough drift to show that a loop takes it out
  // A room this small would all be in the local map, and tracking would close the loop by itself.
  config.slam.tracking.local_map.max_keyframes = 5;
  config.slam.tracking.local_map.neighbours = 2;
  Pipeline system(config);
  Outcome out;
  std::vector<TimedPose> before;
  while (const auto frame = source.next()) {
    if (system.slam().loopCount() == 0) before = system.slam().trajectory();
    out.posed += system.step(*frame).posed() ? 1 : 0;
    ++out.frames;
  }
  system.finish();
  out.loops = system.slam().closedLoops();
  out.ate_before_m = absoluteTrajectoryError(source.groundTruth(), before).translation_m.rmse;
  out.ate_m = absoluteTrajectoryError(source.groundTruth(), system.slam().trajectory()).translation_m.rmse;
  return out;
}

const SE3& truthAt(const FrameSource& source, Stamp stamp) {
  const auto& truth = source.groundTruth();
  return std::find_if(truth.begin(), truth.end(), [&](const TimedPose& pose) { return pose.stamp == stamp; })
      ->T_world_camera;
}

void expectTrueLoops(const FrameSource& source, const Outcome& outcome) {
  ASSERT_FALSE(outcome.loops.empty());
  for (const ClosedLoop& loop : outcome.loops) {
    EXPECT_GT(secondsBetween(loop.matched, loop.current), 10.0) << "a neighbour is no loop";
    const SE3 truth = truthAt(source, loop.current).inverse() * truthAt(source, loop.matched);
    EXPECT_LT((loop.T_current_matched * truth.inverse()).translation().norm(), 0.05);
  }
}

TEST(LoopClosing, ATurnInARoomIsClosedAndItsErrorTakenOut) {
  ScenarioSource source(turnInARoom(1), syntheticCamera("400x300"));
  const Outcome outcome = run(source);
  std::printf("%zu of %zu frames posed, ATE %.4f m before the loop, %.4f m at the end\n", outcome.posed, outcome.frames,
              outcome.ate_before_m, outcome.ate_m);
  EXPECT_GE(outcome.posed + 3, outcome.frames);
  expectTrueLoops(source, outcome);
  EXPECT_LT(outcome.ate_m, outcome.ate_before_m / 3.0);
  EXPECT_LT(outcome.ate_m, 0.05);
}

}  // namespace
}  // namespace semantic_vslam
