// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/runtime/bounded_queue.h"

#include <gtest/gtest.h>

#include <thread>

namespace semantic_vslam {
namespace {

TEST(BoundedQueue, DropsTheOldestAndCountsIt) {
  BoundedQueue<int> queue(2, QueuePolicy::kDropOldest);
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(queue.push(i));
  EXPECT_EQ(*queue.tryPop(), 3);
  EXPECT_EQ(*queue.tryPop(), 4);
  EXPECT_FALSE(queue.tryPop());
  EXPECT_EQ(queue.counters().pushed, 5U);
  EXPECT_EQ(queue.counters().dropped, 3U);
  EXPECT_EQ(queue.counters().high_water, 2U);
}

TEST(BoundedQueue, BlockingPushWaitsForRoomAndLosesNothing) {
  BoundedQueue<int> queue(1, QueuePolicy::kBlock);
  std::thread producer([&queue] {
    for (int i = 0; i < 100; ++i) queue.push(i);
    queue.close();
  });
  int expected = 0;
  while (const auto item = queue.pop()) EXPECT_EQ(*item, expected++);
  producer.join();
  EXPECT_EQ(expected, 100);
  EXPECT_EQ(queue.counters().dropped, 0U);
}

TEST(BoundedQueue, CloseWakesWaitersAndRefusesMore) {
  BoundedQueue<int> queue(1, QueuePolicy::kBlock);
  std::thread consumer([&queue] { EXPECT_FALSE(queue.pop()); });
  queue.close();
  consumer.join();
  EXPECT_FALSE(queue.push(1));
}

}  // namespace
}  // namespace semantic_vslam
