// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/loop_closer.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>

#include "core/runtime/latest_task.h"
#include "core/support/synthetic_map.h"

namespace semantic_vslam {
namespace {

constexpr int kKeyframes = 60;

/// Keyframes on a circle in a room, looking outwards, whose poses are off by a few centimetres.
SyntheticMap circleWithErrors() {
  SyntheticWorld world(3);
  world.addRoom({0, 0, 0}, {8, 3, 8}, 6000);
  SyntheticMap out;
  for (int i = 0; i < kKeyframes; ++i) {
    const double angle = 2.0 * M_PI * i / kKeyframes;
    const Eigen::Quaterniond turned(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()));
    const SE3 T_camera_world = makeSE3(turned, Eigen::Vector3d(0, 0, -1.0));
    Vector6d error = Vector6d::Zero();
    for (int k = 0; k < 3 && i > 0; ++k) error[k] = 0.03 * world.rng().normal();
    addKeyframe(world, out, T_camera_world, se3Exp(error) * T_camera_world, SyntheticWorld::Noise());
  }
  return out;
}

double meanError_m(const Map& map, const std::vector<SE3>& truth) {
  double sum = 0.0;
  for (const auto& [id, keyframe] : map.keyframes()) {
    sum += (keyframe.T_camera_world.inverse().translation() - truth[id.value()].inverse().translation()).norm();
  }
  return sum / static_cast<double>(map.keyframes().size());
}

TEST(LoopCloser, ANewLoopAbortsTheGlobalAdjustmentOfTheOneBeforeWhileTrackingGoesOn) {
  SyntheticMap synthetic = circleWithErrors();
  const double before_m = meanError_m(synthetic.map, synthetic.true_T_camera_world);
  SparseState shared{PlaceIndexConfig(), TrackerConfig()};
  shared.map = std::move(synthetic.map);
  const std::uint64_t version = shared.map.version();
  LoopCloser closer(SparseSlamConfig(), shared);
  std::mutex mutex;
  const Alone alone = [&mutex](const std::function<void()>& use) {
    std::lock_guard<std::mutex> lock(mutex);
    use();
  };
  std::atomic<int> begun{0}, aborted{0}, finished{0};
  LatestTask global_ba("test");
  const auto adjust = [&](const std::atomic<bool>& abort) {
    ++begun;
    closer.adjustAll(alone, abort);
    ++(abort ? aborted : finished);
  };
  global_ba.start(adjust);
  while (begun == 0) std::this_thread::yield();
  global_ba.start(adjust);                                                           // the next loop
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::minutes(8);  // ThreadSanitizer needs some
  while (finished == 0) {  // what tracking does to the map meanwhile
    ASSERT_LT(std::chrono::steady_clock::now(), deadline) << "the second adjustment does not come to its end";
    std::this_thread::yield();
    std::lock_guard<std::mutex> lock(mutex);
    for (const auto& [id, keyframe] : shared.map.keyframes()) {
      static_cast<void>(id);
      if (keyframe.landmarks.front().valid()) shared.map.countVisible(keyframe.landmarks.front());
    }
  }
  global_ba.wait();
  EXPECT_EQ(begun, 2);
  EXPECT_EQ(aborted, 1);
  EXPECT_EQ(shared.map.version(), version + 1) << "the first one changed nothing";
  EXPECT_LT(meanError_m(shared.map, synthetic.true_T_camera_world), 0.3 * before_m);
}

TEST(LoopCloser, AnAbortedAdjustmentChangesNothing) {
  SyntheticMap synthetic = circleWithErrors();
  SparseState shared{PlaceIndexConfig(), TrackerConfig()};
  shared.map = synthetic.map;
  LoopCloser closer(SparseSlamConfig(), shared);
  closer.adjustAll([](const std::function<void()>& use) { use(); }, std::atomic<bool>(true));
  EXPECT_EQ(shared.map.version(), synthetic.map.version());
  for (const auto& [id, keyframe] : synthetic.map.keyframes()) {
    EXPECT_TRUE(shared.map.keyframe(id)->T_camera_world.isApprox(keyframe.T_camera_world, 0.0));
  }
}

}  // namespace
}  // namespace semantic_vslam
