// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/common/stamped_store.h"

#include <gtest/gtest.h>

namespace semantic_vslam {
namespace {

TEST(StampedStore, FindsByStampAndForgetsTheOldest) {
  StampedStore<int> store(2, 1.0);
  for (const int i : {1, 3, 2}) store.put(Stamp{i}, 10 * i);
  EXPECT_FALSE(store.find(Stamp{1}));
  EXPECT_EQ(store.find(Stamp{2}), 20);
  EXPECT_EQ(store.find(Stamp{3}), 30);
}

TEST(StampedStore, StampsThatJumpBackBeginANewRecording) {
  StampedStore<int> store(2);
  for (const double seconds : {100.0, 101.0, 100.5}) store.put(Stamp::fromSeconds(seconds), 1);
  EXPECT_TRUE(store.has(Stamp::fromSeconds(100.5)));
  EXPECT_FALSE(store.has(Stamp::fromSeconds(101.0)));
}

TEST(StampedStore, ANewerValueShowsThatThisOneWillNotCome) {
  StampedStore<int> store(3);
  EXPECT_EQ(store.worthWaitingS(Stamp{5}, 2.0), 2.0);
  store.put(Stamp{4}, 40);
  EXPECT_EQ(store.worthWaitingS(Stamp{5}, 2.0), 2.0);
  store.put(Stamp{6}, 60);
  EXPECT_TRUE(store.passedOver(Stamp{5}));
  EXPECT_EQ(store.worthWaitingS(Stamp{5}, 2.0), 0.0);
}

// A keyframe is named after a frame that follows it has been labelled for want of keyframes.
TEST(StampedStore, InAStreamInDisorderOnlyAMuchNewerValueShowsIt) {
  StampedStore<int> store(3, 1.0);
  store.put(Stamp::fromSeconds(10.5), 105);
  EXPECT_FALSE(store.passedOver(Stamp::fromSeconds(10.0)));
  EXPECT_TRUE(store.passedOver(Stamp::fromSeconds(9.5)));
}

}  // namespace
}  // namespace semantic_vslam
