// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <pthread.h>

#include <atomic>
#include <chrono>
#include <future>
#include <stdexcept>
#include <thread>
#include <vector>

#include "core/runtime/worker.h"

namespace semantic_vslam {
namespace {

using std::chrono::milliseconds;

TEST(Worker, DropsTheOldestOfWhatWaitsAndCountsIt) {
  std::promise<void> begun, release;
  std::vector<int> done;
  {
    Worker<int> worker("test", 2, QueuePolicy::kDropOldest, [&](int i) {
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
    Worker<int> worker("test", 10, QueuePolicy::kBlock, [&](int i) {
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

TEST(Worker, ItsThreadHasAName) {
  char name[16] = "";
  Worker<int> worker("fifteen_letters", 1, QueuePolicy::kBlock,
                     [&](int) { pthread_getname_np(pthread_self(), name, sizeof(name)); });
  worker.push(0);
  worker.finish();
  EXPECT_STREQ(name, "fifteen_letters");
}

TEST(Worker, AnExceptionCostsTheItemNotTheThread) {
  std::vector<int> done;
  Worker<int> worker("test", 10, QueuePolicy::kBlock, [&](int i) {
    if (i == 1) throw std::runtime_error("this one is broken");
    done.push_back(i);
  });
  for (const int i : {0, 1, 2}) worker.push(i);
  worker.finish();
  EXPECT_EQ(done, (std::vector<int>{0, 2}));
  EXPECT_FALSE(worker.push(3)) << "nothing is taken after the end";
}

}  // namespace
}  // namespace semantic_vslam
