// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/runtime/tracking_runner.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>
#include <utility>

#include "core/support/walking_frames.h"

namespace semantic_vslam {
namespace {

using namespace std::chrono_literals;

TEST(TrackingRunner, NoFrameWaitsWhileChangesOfTheMapAreTold) {
  std::atomic<int> tracked{0};
  std::atomic<bool> told{false}, went_on{false};
  TrackingRunner::Hooks hooks;
  hooks.running = [] { return Running{false, false}; };
  hooks.tracked = [&](const TrackingInput&, const TrackingOutput&, StepTime) { ++tracked; };
  hooks.map_changed = [&](const std::shared_ptr<const MapSnapshot>& map) {
    if (map->keyframes() == 0 || told.exchange(true)) return;
    const int before = tracked;
    const auto deadline = std::chrono::steady_clock::now() + 1min;
    while (tracked < before + 10 && std::chrono::steady_clock::now() < deadline) std::this_thread::sleep_for(1ms);
    went_on = tracked >= before + 10;
  };
  TrackingRunner runner(TrackingStage(SparseSlamConfig(), TrackingWaits(), RemovalConfig()), TrackingWaits(),
                        frames().size(), std::move(hooks));
  for (const SyntheticFrame& synthetic : frames()) {
    const RgbdFrame& frame = synthetic.frame;
    runner.push({frame.stamp, 0, [frame] { return frame; }});
  }
  runner.finish();
  EXPECT_TRUE(told);
  EXPECT_TRUE(went_on);
}

}  // namespace
}  // namespace semantic_vslam
