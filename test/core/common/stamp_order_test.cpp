// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/common/stamp_order.h"

#include <gtest/gtest.h>

#include <initializer_list>
#include <vector>

namespace semantic_vslam {
namespace {

using Arrival = StampOrder::Arrival;

/// What becomes of frames stamped so, in seconds.
std::vector<Arrival> arrivals(StampOrder& order, std::initializer_list<double> stamps_s) {
  std::vector<Arrival> out;
  for (const double stamp_s : stamps_s) out.push_back(order.of(Stamp::fromSeconds(stamp_s), 0));
  return out;
}

constexpr Arrival kNext = Arrival::kNext, kOut = Arrival::kOutOfOrder, kBack = Arrival::kSetBack;
using Arrivals = std::vector<Arrival>;

TEST(StampOrder, PassesOverWhatIsNotNewer) {
  StampOrder order;
  EXPECT_EQ(arrivals(order, {10.0, 10.0, 6.0, 10.1}), (Arrivals{kNext, kOut, kOut, kNext}));
}

TEST(StampOrder, FramesThatTheNetworkSwapsAreNoClockThatIsSetBack) {
  StampOrder order;
  EXPECT_EQ(arrivals(order, {1.0, 1.3, 1.1, 1.2, 1.4, 1.6, 1.5, 1.7}),
            (Arrivals{kNext, kNext, kOut, kOut, kNext, kNext, kOut, kNext}));
}

TEST(StampOrder, FollowsAClockThatIsSetBackByHowEverLittle) {
  for (const double back_s : {0.2, 2.0, 5.0, 3600.0}) {
    StampOrder order;
    const double start_s = 5000.0, s = start_s - back_s;
    EXPECT_EQ(arrivals(order, {start_s, s, s + 0.03, s + 0.06, s + 0.09}), (Arrivals{kNext, kOut, kOut, kBack, kNext}))
        << back_s;
  }
}

TEST(StampOrder, FollowsAShortRecordingInALoop) {
  StampOrder order;
  int followed = 0;
  for (int lap = 0; lap < 4; ++lap) {
    for (int i = 0; i < 30; ++i) {
      const Arrival arrival = order.of(Stamp::fromSeconds(100.0 + 0.033 * i), 0);
      EXPECT_EQ(arrival, lap == 0 ? kNext : i < 2 ? kOut : i == 2 ? kBack : kNext) << lap << " " << i;
      followed += arrival == kOut ? 0 : 1;
    }
  }
  EXPECT_EQ(followed, 4 * 30 - 3 * 2);
}

TEST(StampOrder, OneStampInTheFutureOrThePastCostsItsFrameAlone) {
  StampOrder order;
  EXPECT_EQ(arrivals(order, {10.0, 10.03, 3610.06, 10.09, 0.0, 10.12, 7210.0, 3610.0, 10.15}),
            (Arrivals{kNext, kNext, kOut, kNext, kOut, kNext, kOut, kOut, kNext}));
}

TEST(StampOrder, AfterALongPauseFramesThatAgreeAreFollowed) {
  StampOrder order;
  EXPECT_EQ(arrivals(order, {10.0, 10.03, 70.0, 70.03, 70.06, 70.09}),
            (Arrivals{kNext, kNext, kOut, kOut, kNext, kNext}));
}

TEST(StampOrder, FirstStampsThatAreWrongAreLeftBehind) {
  StampOrder order;
  EXPECT_EQ(arrivals(order, {3610.0, 10.0, 10.03, 10.06}), (Arrivals{kNext, kOut, kOut, kBack}));
}

TEST(StampOrder, FramesThatAreRareAreFollowedOnceThatIsKnown) {
  StampOrder order;
  EXPECT_EQ(arrivals(order, {0.0, 20.0, 40.0, 60.0, 80.0, 110.0}), (Arrivals{kNext, kOut, kOut, kNext, kNext, kNext}));
  StampOrder numbered;
  EXPECT_EQ(arrivals(numbered, {1.0, 2.0, 3.0}), (Arrivals{kNext, kNext, kNext}));
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
