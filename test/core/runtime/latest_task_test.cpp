// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/runtime/latest_task.h"

#include <gtest/gtest.h>
#include <pthread.h>

#include <atomic>
#include <future>
#include <new>
#include <vector>

namespace semantic_vslam {
namespace {

/// Runs until it is aborted.
void untilAborted(const std::atomic<bool>& abort) {
  while (!abort) std::this_thread::yield();
}

TEST(LatestTask, WaitReturnsWhenTheTaskIsDone) {
  LatestTask tasks("test");
  tasks.wait();
  int done = 0;
  for (int i = 0; i < 3; ++i) {
    tasks.start([&](const std::atomic<bool>& abort) { done += abort ? 0 : 1; });
    tasks.wait();
  }
  EXPECT_EQ(done, 3);
}

TEST(LatestTask, ItsThreadHasAName) {
  LatestTask tasks("adjustment");
  char name[16] = "";
  tasks.start([&](const std::atomic<bool>&) { pthread_getname_np(pthread_self(), name, sizeof(name)); });
  tasks.wait();
  EXPECT_STREQ(name, "adjustment");
}

TEST(LatestTask, ANewTaskAbortsTheOneInWorkAndIsNotAbortedItself) {
  LatestTask tasks("test");
  std::promise<void> started;
  bool first_was_aborted = false, second_was_aborted = true;
  tasks.start([&](const std::atomic<bool>& abort) {
    started.set_value();
    untilAborted(abort);
    first_was_aborted = abort;
  });
  started.get_future().wait();
  tasks.start([&](const std::atomic<bool>& abort) { second_was_aborted = abort; });
  tasks.wait();
  EXPECT_TRUE(first_was_aborted);
  EXPECT_FALSE(second_was_aborted);
}

TEST(LatestTask, OfSeveralWaitingOnlyTheNewestRuns) {
  LatestTask tasks("test");
  std::promise<void> started, all_queued;
  std::vector<int> ran;
  tasks.start([&](const std::atomic<bool>&) {
    started.set_value();
    all_queued.get_future().wait();
  });
  started.get_future().wait();
  for (int i = 0; i < 3; ++i) tasks.start([&ran, i](const std::atomic<bool>&) { ran.push_back(i); });
  all_queued.set_value();
  tasks.wait();
  EXPECT_EQ(ran, std::vector<int>{2});
}

TEST(LatestTask, CancelAndTheDestructorEndWhatIsInWork) {
  LatestTask cancelled("test");
  std::atomic<int> ended{0};
  const auto task = [&](const std::atomic<bool>& abort) {
    untilAborted(abort);
    ++ended;
  };
  {
    LatestTask destroyed("test");
    std::promise<void> started;
    destroyed.start([&](const std::atomic<bool>& abort) {
      started.set_value();
      task(abort);
    });
    started.get_future().wait();
  }
  EXPECT_EQ(ended, 1);
  std::promise<void> started;
  cancelled.start([&](const std::atomic<bool>& abort) {
    started.set_value();
    task(abort);
  });
  started.get_future().wait();
  cancelled.cancel();
  EXPECT_EQ(ended, 2);
}

TEST(LatestTask, AnExceptionCostsTheTaskNotTheProcess) {
  LatestTask tasks("test");
  tasks.start([](const std::atomic<bool>&) { throw std::bad_alloc(); });
  tasks.wait();
  std::atomic<bool> ran{false};
  tasks.start([&](const std::atomic<bool>&) { ran = true; });
  tasks.wait();
  EXPECT_TRUE(ran);
}

}  // namespace
}  // namespace semantic_vslam
