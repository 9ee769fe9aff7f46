// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/runtime/inbox.h"

#include <gtest/gtest.h>

#include <vector>

namespace semantic_vslam {
namespace {

TEST(Inbox, AStageThatAsksForNothingLosesTheOldestButNotWhatMustArrive) {
  Inbox<std::vector<int>> inbox;
  const int many = static_cast<int>(Inbox<std::vector<int>>::kMost) + 50;
  inbox.put([](std::vector<int>& stage) { stage.push_back(-1); }, true);
  for (int i = 0; i < many; ++i) inbox.put([i](std::vector<int>& stage) { stage.push_back(i); });
  std::vector<int> stage;
  inbox.deliver(stage);
  ASSERT_EQ(stage.size(), Inbox<std::vector<int>>::kMost);
  EXPECT_EQ(stage.front(), -1) << "the list of classes, say";
  EXPECT_EQ(stage[1], 51);
  EXPECT_EQ(stage.back(), many - 1);
  inbox.deliver(stage);
  EXPECT_EQ(stage.size(), Inbox<std::vector<int>>::kMost) << "each arrives once";
}

}  // namespace
}  // namespace semantic_vslam
