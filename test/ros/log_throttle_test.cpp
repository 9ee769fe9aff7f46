// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/log_throttle.h"

#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <thread>

namespace semantic_vslam {
namespace {

TEST(LogThrottle, FaultsThatTakeTurnsAreSaidOnceEach) {
  LogThrottle throttle;
  int said = 0;
  for (int i = 0; i < 100; ++i) {
    said += throttle.passes("colour has no stamp") ? 1 : 0;
    said += throttle.passes("depth has no stamp") ? 1 : 0;
  }
  EXPECT_EQ(said, 2);
}

TEST(LogThrottle, AFaultIsNewsWhenItStayedAwayWhileAnotherWasSaid) {
  LogThrottle throttle;
  const auto wait = [] { std::this_thread::sleep_for(std::chrono::milliseconds(600)); };
  EXPECT_TRUE(throttle.passes("no images"));
  wait();
  EXPECT_FALSE(throttle.passes("no images")) << "it is the same fault still";
  EXPECT_TRUE(throttle.passes("no depth"));
  EXPECT_FALSE(throttle.passes("no images")) << "it was there all the time";
  wait();
  EXPECT_TRUE(throttle.passes("no images"));
  EXPECT_FALSE(throttle.passes("no images"));
}

TEST(LogThrottle, AFaultThatComesAgainAfterAllWasWellIsNews) {
  LogThrottle throttle;
  EXPECT_TRUE(throttle.passes("no images"));
  EXPECT_FALSE(throttle.passes("no images"));
  EXPECT_FALSE(throttle.passes(""));
  EXPECT_TRUE(throttle.passes("no images"));
}

TEST(LogThrottle, RemembersAFewMessagesOnly) {
  LogThrottle throttle;
  EXPECT_TRUE(throttle.passes("first"));
  for (int i = 0; i < 1000; ++i) throttle.passes(std::to_string(i));
  EXPECT_TRUE(throttle.passes("first"));
}

}  // namespace
}  // namespace semantic_vslam
