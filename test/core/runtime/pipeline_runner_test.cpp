// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "semantic_vslam/core/runtime/pipeline_runner.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "core/dense/dense_mapper.h"
#include "core/pipeline/sparse_slam.h"
#include "core/support/motion_alone.h"
#include "core/support/walking_frames.h"
#include "eval/trajectory_error.h"
#include "semantic_vslam/core/pipeline/pipeline.h"

namespace semantic_vslam {
namespace {

using namespace std::chrono_literals;

TEST(PipelineRunner, EveryFrameComesOutInOrderWhereThereIsTime) {
  std::atomic<std::size_t> out{0};
  std::vector<std::uint64_t> order;
  std::size_t posed = 0;
  PipelineRunner runner(sparse(), [&](const RgbdFrame& frame, const StepResult& step) {
    order.push_back(frame.index);
    posed += step.posed() ? 1 : 0;
    ++out;
  });
  for (std::size_t i = 0; i < frames().size(); ++i) {
    runner.push(frames()[i].frame);
    while (out + 3 < i) std::this_thread::sleep_for(1ms);  // three on their way leave no queue full
  }
  runner.finish();
  EXPECT_EQ(runner.dropped(), 0U);
  ASSERT_EQ(order.size(), frames().size());
  for (std::size_t i = 0; i < order.size(); ++i) EXPECT_EQ(order[i], i);
  EXPECT_EQ(posed, frames().size() - 1) << "k1 gets its pose afterwards";
}

/// Names of this process's threads, as `top -H` shows them.
std::set<std::string> threadNames() {
  std::set<std::string> names;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
    std::ifstream file(task.path() / "comm");
    std::string name;
    if (std::getline(file, name)) names.insert(name);
  }
  return names;
}

TEST(PipelineRunner, ItsThreadsHaveNames) {
  PipelineRunner runner(sparse(), [](const RgbdFrame&, const StepResult&) {});
  const std::set<std::string> wanted{"slam_motion", "slam_tracking", "slam_upkeep", "slam_labels", "slam_dense"};
  const auto all = [&] {
    const std::set<std::string> names = threadNames();
    return std::includes(names.begin(), names.end(), wanted.begin(), wanted.end());
  };
  for (int i = 0; i < 1000 && !all(); ++i) std::this_thread::sleep_for(5ms);  // each thread names itself
  EXPECT_TRUE(all()) << testing::PrintToString(threadNames());
}

TEST(PipelineRunner, WhoFallsBehindLosesTheOldestFramesThatWait) {
  std::vector<std::uint64_t> order;
  PipelineRunner runner(sparse(), [&](const RgbdFrame& frame, const StepResult&) { order.push_back(frame.index); });
  for (const SyntheticFrame& synthetic : frames()) runner.push(synthetic.frame);
  runner.finish();
  EXPECT_GT(runner.dropped(), 0U) << "two dozen frames at once are too many";
  EXPECT_EQ(order.size() + runner.dropped(), frames().size());
  EXPECT_TRUE(std::is_sorted(order.begin(), order.end()));
  EXPECT_EQ(order.back(), frames().back().frame.index) << "the newest is never lost";
}

TEST(PipelineRunner, WhatTheSinkThrowsEndsTheRunAndComesOutOfFinish) {
  PipelineRunner runner(sparse(), [](const RgbdFrame& frame, const StepResult&) {
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

/// The frame as if it had been taken later.
RgbdFrame at(const RgbdFrame& frame, int index) {
  RgbdFrame later = frame;
  later.index = static_cast<std::uint64_t>(index);
  later.stamp = Stamp{frames().front().frame.stamp.ns + index * 33'333'333LL};
  return later;
}

/// 200 frames, forth and back over the same pictures, while somebody else asks for poses and saves the map: what
/// nodelets do, and what ThreadSanitizer is to see.
TEST(PipelineRunner, TwoHundredFramesOnWorkersWhileOthersRead) {
  std::atomic<int> out{0}, posed{0};
  PipelineRunner runner(motionAlone(), [&](const RgbdFrame&, const StepResult& step) {
    posed += step.posed() ? 1 : 0;
    ++out;
  });
  const std::string file = testing::TempDir() + "/two_hundred_frames.map";
  std::atomic<bool> done{false};
  std::size_t reads = 0;
  std::thread reader([&] {
    while (!done) {
      Map map;
      bool posed_yet = false;
      runner.read([&](const SparseSlam& slam) {
        posed_yet = !slam.trajectory().empty() && !slam.keyframePoses().empty();
        map = slam.map();
      });
      if (!posed_yet) continue;
      SparseSlam::saveMap(file, map);
      ++reads;
      std::this_thread::sleep_for(50ms);
    }
  });
  const int last = kFrames - 1;
  std::vector<TimedPose> truth;
  for (int i = 0; i < 200; ++i) {
    const int phase = i % (2 * last);
    const SyntheticFrame& synthetic = frames()[static_cast<std::size_t>(phase <= last ? phase : 2 * last - phase)];
    const RgbdFrame frame = at(synthetic.frame, i);
    truth.push_back({frame.stamp, synthetic.T_world_camera});
    runner.push(frame);
    while (out + 3 < i) std::this_thread::sleep_for(1ms);  // three on their way leave no queue full
  }
  done = true;
  reader.join();
  runner.finish();
  EXPECT_GE(posed + static_cast<int>(runner.dropped()), 198);
  EXPECT_GE(posed, 190);
  EXPECT_GT(reads, 0U);
  EXPECT_LT(absoluteTrajectoryError(truth, runner.slam().trajectory()).translation_m.rmse, 0.03);
  EXPECT_GT(runner.dense().cloud().size(), 10000U);
  SparseSlam restored{SparseSlamConfig()};
  EXPECT_NO_THROW(restored.loadMap(file)) << "saved while workers changed the map";
}

/// Answers the first question at once and the second when it is let go.
class SlowSegmenter final : public Segmenter {
 public:
  SlowSegmenter(std::atomic<int>& asked, std::atomic<bool>& go) : asked_(asked), go_(go) {}
  const LabelSet& labels() const override { return labels_; }
  Segmentation segment(const cv::Mat3b& bgr) override {
    if (++asked_ > 1) {
      while (!go_) std::this_thread::yield();
    }
    return {cv::Mat1b::zeros(bgr.size())};
  }

 private:
  std::atomic<int>& asked_;
  std::atomic<bool>& go_;
  LabelSet labels_ = syntheticLabels();
};

TEST(PipelineRunner, FramesBetweenKeyframesDoNotQueueBehindABusyNetwork) {
  std::atomic<int> asked{0}, out{0};
  std::atomic<bool> go{false};
  PipelineRunner runner(SystemConfig(), std::make_unique<SlowSegmenter>(asked, go),
                        [&](const RgbdFrame&, const StepResult&) { ++out; });
  int pushed = 0;
  const auto stand = [&] {
    runner.push(at(frames()[0].frame, pushed++));
    while (out + 3 < pushed) std::this_thread::sleep_for(1ms);
  };
  const auto deadline = std::chrono::steady_clock::now() + 2min;
  while (asked < 2 && std::chrono::steady_clock::now() < deadline) stand();
  ASSERT_EQ(asked, 2) << "k1, and a frame half a second or more later";
  for (int i = 0; i < 60; ++i) stand();  // two seconds
  go = true;
  runner.finish();
  EXPECT_LE(asked, 3) << "the newest of those that waited, at most";
  EXPECT_EQ(runner.slam().keyframeCount(), 1U);
}

/// What a wiring decides of each frame, and the map it makes.
struct Decisions {
  std::vector<cv::Mat1b> removed;
  std::vector<int> labelled;
  std::vector<TimedPose> trajectory;
  std::vector<LabelledPoint> cloud;
};

cv::Mat1b orEmpty(const cv::Mat1b& removed) {
  return removed.empty() ? cv::Mat1b(cv::Mat1b::zeros(240, 320)) : removed.clone();
}

Decisions byCalls() {
  Decisions out;
  Pipeline pipeline(SystemConfig(), std::make_unique<NotingNetwork>(out.labelled));
  for (const SyntheticFrame& synthetic : frames())
    out.removed.push_back(orEmpty(pipeline.step(synthetic.frame).removed));
  pipeline.finish();
  out.trajectory = pipeline.slam().trajectory();
  out.cloud = pipeline.dense().cloud();
  return out;
}

Decisions onThreads() {
  Decisions out;
  SystemConfig config;
  config.waits.mask_budget_ms = 1000;  // what is compared is what they decide, not how fast
  PipelineRunner runner(
      config, std::make_unique<NotingNetwork>(out.labelled),
      [&](const RgbdFrame&, const StepResult& step) { out.removed.push_back(orEmpty(step.removed)); });
  for (const SyntheticFrame& synthetic : frames()) {
    runner.push(synthetic.frame);
    runner.settle();
  }
  runner.finish();
  EXPECT_EQ(runner.dropped(), 0U);
  out.trajectory = runner.slam().trajectory();
  out.cloud = runner.dense().cloud();
  return out;
}

TEST(PipelineRunner, WhereThereIsTimeThreadsDecideWhatCallsDo) {
  const Decisions calls = byCalls(), threads = onThreads();
  EXPECT_EQ(calls.labelled, threads.labelled);
  ASSERT_EQ(calls.removed.size(), threads.removed.size());
  for (std::size_t i = 0; i < calls.removed.size(); ++i) {
    EXPECT_EQ(cv::countNonZero(calls.removed[i] != threads.removed[i]), 0) << "frame " << i;
  }
  ASSERT_EQ(calls.trajectory.size(), threads.trajectory.size());
  for (std::size_t i = 0; i < calls.trajectory.size(); ++i) {
    EXPECT_EQ(calls.trajectory[i].T_world_camera.matrix(), threads.trajectory[i].T_world_camera.matrix()) << i;
  }
  EXPECT_NEAR(static_cast<double>(threads.cloud.size()), static_cast<double>(calls.cloud.size()),
              0.02 * static_cast<double>(calls.cloud.size()));
}

}  // namespace
}  // namespace semantic_vslam
