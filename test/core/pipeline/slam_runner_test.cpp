// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/slam_runner.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <memory>
#include <stdexcept>
#include <thread>
#include <vector>

#include "core/support/quarter_vga.h"
#include "eval/mask_score.h"
#include "eval/synthetic_room.h"

namespace semantic_vslam {
namespace {

using namespace std::chrono_literals;

constexpr int kFrames = 24;

/// From where somebody stands well in the picture.
const std::vector<SyntheticFrame>& frames() {
  static const std::vector<SyntheticFrame> rendered = [] {
    const SyntheticRoom room(makeScenario("walking", 1), quarterVga());
    std::vector<SyntheticFrame> all;
    for (int i = 0; i < kFrames; ++i) {
      all.push_back(room.render(room.frameTime(i + 20)));
      all.back().frame.index = static_cast<std::uint64_t>(i);
    }
    return all;
  }();
  return rendered;
}

/// A network that knows the truth and notes what it was asked for.
class NotingNetwork final : public Segmenter {
 public:
  explicit NotingNetwork(std::vector<int>& asked) : asked_(asked) {}

  const LabelSet& labels() const override { return labels_; }
  Segmentation segment(const cv::Mat3b& bgr) override {
    for (const SyntheticFrame& synthetic : frames()) {
      if (synthetic.frame.bgr.data != bgr.data) continue;
      asked_.push_back(static_cast<int>(synthetic.frame.index));
      return {synthetic.labels};
    }
    return {cv::Mat1b::zeros(bgr.size())};
  }

 private:
  std::vector<int>& asked_;
  LabelSet labels_ = syntheticLabels();
};

SystemConfig sparse() {
  SystemConfig config;
  config.dense.enabled = false;
  return config;
}

TEST(SlamRunner, EveryFrameComesOutInOrderWhereThereIsTime) {
  SlamSystem system(sparse(), SlamSystem::Mode::kBackground);
  std::atomic<std::size_t> out{0};
  std::vector<std::uint64_t> order;
  std::size_t posed = 0;
  SlamRunner runner(system, [&](const RgbdFrame& frame, const StepResult& step) {
    order.push_back(frame.index);
    posed += step.posed ? 1 : 0;
    ++out;
  });
  for (std::size_t i = 0; i < frames().size(); ++i) {
    runner.push(frames()[i].frame);
    while (out + 3 < i) std::this_thread::sleep_for(1ms);  // three on their way leave no queue full
  }
  runner.finish();
  system.finish();
  EXPECT_EQ(runner.dropped(), 0U);
  ASSERT_EQ(order.size(), frames().size());
  for (std::size_t i = 0; i < order.size(); ++i) EXPECT_EQ(order[i], i);
  EXPECT_EQ(posed, frames().size() - 1) << "k1 gets its pose afterwards";
}

TEST(SlamRunner, WhoFallsBehindLosesTheOldestFramesThatWait) {
  SlamSystem system(sparse(), SlamSystem::Mode::kBackground);
  std::vector<std::uint64_t> order;
  SlamRunner runner(system, [&](const RgbdFrame& frame, const StepResult&) { order.push_back(frame.index); });
  for (const SyntheticFrame& synthetic : frames()) runner.push(synthetic.frame);
  runner.finish();
  system.finish();
  EXPECT_GT(runner.dropped(), 0U) << "two dozen frames at once are too many";
  EXPECT_EQ(order.size() + runner.dropped(), frames().size());
  EXPECT_TRUE(std::is_sorted(order.begin(), order.end()));
  EXPECT_EQ(order.back(), frames().back().frame.index) << "the newest is never lost";
}

TEST(SlamRunner, WhatTheSinkThrowsEndsTheRunAndComesOutOfFinish) {
  SlamSystem system(sparse(), SlamSystem::Mode::kBackground);
  SlamRunner runner(system, [](const RgbdFrame& frame, const StepResult&) {
    if (frame.index >= 3) throw std::runtime_error("the disk is full");
  });
  std::size_t pushed = 0;
  const auto deadline = std::chrono::steady_clock::now() + 1min;
  while (runner.push(frames()[pushed % frames().size()].frame) && std::chrono::steady_clock::now() < deadline) {
    ++pushed;
    std::this_thread::sleep_for(20ms);
  }
  EXPECT_LT(std::chrono::steady_clock::now(), deadline) << "push() must tell that nothing is taken any more";
  EXPECT_GT(pushed, 3U);
  EXPECT_THROW(runner.finish(), std::runtime_error);
  runner.finish();  // once is enough
}

TEST(SlamSystem, OnlyK1IsSegmentedBeforeTrackingAndItsPeopleAreCarriedOn) {
  std::vector<int> asked;
  SystemConfig config = sparse();
  config.motion.model = "none";  // nothing but the labels tells what is dynamic
  SlamSystem system(config, SlamSystem::Mode::kSynchronous, std::make_unique<NotingNetwork>(asked));
  ASSERT_GT(cv::countNonZero(frames()[1].person_mask), 0.05 * 320 * 240) << "somebody is there";
  const StepResult k1 = system.step(frames()[0].frame);
  EXPECT_EQ(k1.tracking.state, TrackingState::kInitialising);
  ASSERT_EQ(asked, std::vector<int>{0});
  std::optional<ObservedFrame> observed = system.observe(frames()[1].frame);
  ASSERT_TRUE(observed);
  EXPECT_EQ(asked.size(), 1U) << "k2 waits for no network";
  MaskScore carried;
  carried.add(observed->motion.dynamic, frames()[1].person_mask);
  EXPECT_GT(carried.iou(), 0.8);
  EXPECT_TRUE(system.track(std::move(*observed)).posed);
}

TEST(SlamSystem, WhereK2DoesNotFitLabelsAreRenewedInTime) {
  std::vector<int> asked;
  SystemConfig config = sparse();
  config.slam.tracking.initializer.min_inliers = 5000;  // no pair ever fits
  SlamSystem system(config, SlamSystem::Mode::kSynchronous, std::make_unique<NotingNetwork>(asked));
  for (const SyntheticFrame& synthetic : frames()) system.step(synthetic.frame);
  EXPECT_EQ(asked, (std::vector<int>{0, 16})) << "every half second, not every frame";
}

TEST(SlamSystem, AFrameWithoutLabelsMayBecomeK2ButNeverK1) {
  std::vector<int> asked;
  SystemConfig config = sparse();
  config.label_delay_s = 10.0;                          // labels are never carried on in time
  config.slam.tracking.initializer.min_inliers = 5000;  // no pair ever fits
  SlamSystem system(config, SlamSystem::Mode::kSynchronous, std::make_unique<NotingNetwork>(asked));
  for (int i = 0; i < 6; ++i) system.step(frames()[i].frame);
  EXPECT_EQ(asked, (std::vector<int>{0, 2, 4})) << "where k2 does not fit the next frame is segmented as k1";
}

}  // namespace
}  // namespace semantic_vslam
