// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/common/stamp_order.h"

#include <gtest/gtest.h>

namespace semantic_vslam {
namespace {

using Arrival = StampOrder::Arrival;

TEST(StampOrder, PassesOverWhatIsNotNewer) {
  StampOrder order;
  EXPECT_EQ(order.of(Stamp::fromSeconds(10.0), 0), Arrival::kNext);
  EXPECT_EQ(order.of(Stamp::fromSeconds(10.0), 0), Arrival::kLate);
  EXPECT_EQ(order.of(Stamp::fromSeconds(6.0), 0), Arrival::kLate);
  EXPECT_EQ(order.of(Stamp::fromSeconds(10.1), 0), Arrival::kNext);
}

TEST(StampOrder, FollowsAClockThatIsSetBack) {
  StampOrder order;
  order.of(Stamp::fromSeconds(100.0), 0);
  EXPECT_EQ(order.of(Stamp::fromSeconds(90.0), 0), Arrival::kSetBack);
  EXPECT_EQ(order.of(Stamp::fromSeconds(90.1), 0), Arrival::kNext);
}

TEST(StampOrder, ARecordingThatIsPlayedAgainBeginsAnewWhateverItsStamps) {
  StampOrder order;
  order.of(Stamp::fromSeconds(100.0), 0);
  EXPECT_EQ(order.of(Stamp::fromSeconds(99.0), 1), Arrival::kPlayedAgain);
  EXPECT_EQ(order.of(Stamp::fromSeconds(99.1), 1), Arrival::kNext);
  EXPECT_EQ(order.of(Stamp::fromSeconds(200.0), 2), Arrival::kPlayedAgain);
}

TEST(StampOrder, TheFirstFrameOfAllIsNoSecondRecording) {
  StampOrder order;
  EXPECT_EQ(order.of(Stamp::fromSeconds(1.0), 7), Arrival::kNext);
}

}  // namespace
}  // namespace semantic_vslam
