// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <chrono>
#include <future>
#include <string>
#include <thread>
#include <vector>

#include "core/runtime/worker.h"
#include "ros/stamped_buffer.h"

namespace semantic_vslam {
namespace {

using std::chrono::milliseconds;

TEST(StampedBuffer, FindsByStampAndForgetsTheOldest) {
  StampedBuffer<int> buffer(2, 1.0);
  for (const int i : {1, 3, 2}) buffer.put(Stamp{i}, 10 * i);
  EXPECT_FALSE(buffer.find(Stamp{1}));
  EXPECT_EQ(buffer.find(Stamp{2}), 20);
  EXPECT_EQ(buffer.find(Stamp{3}), 30);
  EXPECT_EQ(buffer.newest(), Stamp{3});
}

TEST(StampedBuffer, StampsThatJumpBackBeginANewRecording) {
  StampedBuffer<int> buffer(2);
  for (const double seconds : {100.0, 101.0, 100.5}) buffer.put(Stamp::fromSeconds(seconds), 1);
  EXPECT_EQ(buffer.newest(), Stamp::fromSeconds(100.5));
  EXPECT_FALSE(buffer.find(Stamp::fromSeconds(101.0)));
}

TEST(StampedBuffer, WaitEndsWhenTheValueComes) {
  StampedBuffer<std::string> buffer(3);
  auto waiting = std::async(std::launch::async, [&] { return buffer.waitFor(Stamp{5}, milliseconds(10000)); });
  buffer.put(Stamp{5}, "mask");
  EXPECT_EQ(waiting.get(), std::string("mask"));
}

TEST(StampedBuffer, WaitEndsWhenANewerValueShowsThatThisOneWillNotCome) {
  StampedBuffer<int> buffer(3);
  auto waiting = std::async(std::launch::async, [&] { return buffer.waitFor(Stamp{5}, milliseconds(600000)); });
  buffer.put(Stamp{6}, 60);
  EXPECT_FALSE(waiting.get());
}

// A keyframe is named after a frame that follows it has been labelled for want of keyframes.
TEST(StampedBuffer, WaitGoesOnPastNewerValuesOfAStreamInDisorder) {
  StampedBuffer<int> buffer(3, 1.0);
  const Stamp stamp = Stamp::fromSeconds(10.0);
  buffer.put(Stamp::fromSeconds(10.5), 105);
  auto waiting = std::async(std::launch::async, [&] { return buffer.waitFor(stamp, milliseconds(600000)); });
  EXPECT_EQ(waiting.wait_for(milliseconds(50)), std::future_status::timeout);
  buffer.put(stamp, 100);
  EXPECT_EQ(waiting.get(), 100);
  EXPECT_FALSE(buffer.waitFor(Stamp::fromSeconds(9.5), milliseconds(600000)));
}

TEST(StampedBuffer, WaitEndsAfterItsBudget) {
  StampedBuffer<int> buffer(3);
  buffer.put(Stamp{4}, 40);
  EXPECT_FALSE(buffer.waitFor(Stamp{5}, milliseconds(1)));
}

TEST(StampedBuffer, CloseWakesWaiters) {
  StampedBuffer<int> buffer(3);
  auto waiting = std::async(std::launch::async, [&] { return buffer.waitFor(Stamp{5}, milliseconds(600000)); });
  buffer.close();
  EXPECT_FALSE(waiting.get());
}

TEST(Worker, DropsTheOldestOfWhatWaitsAndCountsIt) {
  std::promise<void> begun, release;
  std::vector<int> done;
  {
    Worker<int> worker(2, QueuePolicy::kDropOldest, [&](int i) {
      if (i == 0) {
        begun.set_value();
        release.get_future().wait();
      }
      done.push_back(i);
    });
    worker.push(0);
    begun.get_future().wait();
    for (const int i : {1, 2, 3}) worker.push(i);
    EXPECT_EQ(worker.counters().dropped, 1U);
    release.set_value();
    while (worker.waiting() > 0) std::this_thread::yield();
  }
  EXPECT_EQ(done.front(), 0);
  EXPECT_EQ(done[1], 2);
}

TEST(Worker, DestructionFinishesWhatRunsAndDropsWhatWaits) {
  std::promise<void> begun;
  std::atomic<int> finished{0};
  {
    Worker<int> worker(10, QueuePolicy::kBlock, [&](int i) {
      if (i == 0) begun.set_value();
      std::this_thread::sleep_for(milliseconds(20));
      ++finished;
    });
    for (int i = 0; i < 10; ++i) worker.push(i);
    begun.get_future().wait();
  }
  EXPECT_GE(finished, 1);
  EXPECT_LT(finished, 10);
}

}  // namespace
}  // namespace semantic_vslam
