// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/labelled_start.h"

#include <gtest/gtest.h>

namespace semantic_vslam {
namespace {

TEST(LabelledStart, BeginsWithTheFirstMaskThatCarriesLabels) {
  LabelledStart start;
  EXPECT_FALSE(start.at(Stamp{5}));
  start.add(Stamp{5}, {});
  EXPECT_FALSE(start.at(Stamp{5}));
  start.add(Stamp{6}, Stamp{4});
  EXPECT_FALSE(start.at(Stamp{5}));
  EXPECT_TRUE(start.at(Stamp{6}));
  start.add(Stamp{7}, Stamp{4});
  EXPECT_TRUE(start.at(Stamp{6}));
  EXPECT_TRUE(start.at(Stamp{8}));
}

TEST(LabelledStart, EndsWithAMotionStageThatForgetsTheLabels) {
  LabelledStart start;
  start.add(Stamp{6}, Stamp{4});
  start.add(Stamp{7}, {});
  EXPECT_FALSE(start.at(Stamp{8}));
}

TEST(LabelledStart, AfterARestartOnlyNewerLabelsCount) {
  LabelledStart start;
  start.add(Stamp{6}, Stamp{4});
  start.restart();
  EXPECT_FALSE(start.at(Stamp{7}));
  start.add(Stamp{7}, Stamp{4});
  EXPECT_FALSE(start.at(Stamp{7}));
  start.add(Stamp{9}, Stamp{7});
  EXPECT_TRUE(start.at(Stamp{9}));
}

// Tracking and motion see that a recording is played again in no fixed order.
TEST(LabelledStart, ARecordingPlayedAgainDoesNotWaitForItsOldStamps) {
  for (const bool tracking_first : {true, false}) {
    LabelledStart start;
    start.add(Stamp{100}, Stamp{98});
    if (tracking_first) start.restart();
    start.add(Stamp{1}, {});
    if (!tracking_first) start.restart();
    EXPECT_FALSE(start.at(Stamp{1}));
    start.add(Stamp{3}, Stamp{2});
    EXPECT_TRUE(start.at(Stamp{3})) << tracking_first;
  }
}

}  // namespace
}  // namespace semantic_vslam
