// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/log_throttle.h"

#include <gtest/gtest.h>

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
