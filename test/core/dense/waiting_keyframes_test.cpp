// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/dense/waiting_keyframes.h"

#include <gtest/gtest.h>

#include "dense_scene.h"

namespace semantic_vslam {
namespace {

KeyframePose poseOf(std::uint64_t id, double z_m) {
  KeyframePose pose{KeyframeId(id), Stamp{}, SE3::Identity()};
  pose.T_world_camera.translation().z() = z_m;
  return pose;
}

DenseInput wall(std::uint64_t id) { return {KeyframeId(id), wallFrame(2.02F), cv::Mat1b(), cv::Mat1b()}; }

TEST(WaitingKeyframes, EnterTheMapWhereTheyArePlacedAtLast) {
  DenseMapper map(DenseConfig(), threeLabels());
  WaitingKeyframes waiting;
  waiting.add(wall(3));
  waiting.add(wall(5));
  waiting.place({poseOf(1, 0.0)}, map);
  EXPECT_EQ(map.keyframes(), 0U);
  waiting.place({poseOf(1, 0.0), poseOf(5, 3.0)}, map);
  EXPECT_EQ(map.keyframes(), 1U);
  EXPECT_EQ(waiting.size(), 1U) << "the other goes on waiting";
  const auto cloud = map.cloud();
  ASSERT_FALSE(cloud.empty());
  EXPECT_NEAR(cloud.front().xyz_m[2], 5.02, 1e-5);
  waiting.place({poseOf(5, 3.0)}, map);
  EXPECT_EQ(map.keyframes(), 1U) << "once";
}

TEST(WaitingKeyframes, TheOldestGoWhenTheyAreTooMany) {
  DenseMapper map(DenseConfig(), threeLabels());
  WaitingKeyframes waiting;
  for (std::uint64_t id = 0; id <= WaitingKeyframes::kMost; ++id) waiting.add(wall(id));
  waiting.place({}, map);
  EXPECT_EQ(waiting.size(), WaitingKeyframes::kMost);
  waiting.place({poseOf(0, 0.0)}, map);
  EXPECT_EQ(map.keyframes(), 0U);
  waiting.place({poseOf(1, 0.0), poseOf(2, 0.0)}, map);
  EXPECT_EQ(map.keyframes(), 2U);
}

TEST(WaitingKeyframes, WhatCanBePlacedIsPlacedBeforeAnyGo) {
  DenseMapper map(DenseConfig(), threeLabels());
  WaitingKeyframes waiting;
  for (std::uint64_t id = 0; id <= WaitingKeyframes::kMost; ++id) waiting.add(wall(id));
  waiting.place({poseOf(0, 0.0)}, map);
  EXPECT_EQ(map.keyframes(), 1U);
  EXPECT_EQ(waiting.size(), WaitingKeyframes::kMost);
}

TEST(WaitingKeyframes, ThoseThatNobodyWillPlaceAreDropped) {
  WaitingKeyframes waiting;
  for (const std::uint64_t id : {1, 2, 3}) waiting.add(wall(id));
  waiting.keepOnly([](KeyframeId id) { return id != KeyframeId(2); });
  EXPECT_EQ(waiting.size(), 2U);
  waiting.clear();
  EXPECT_EQ(waiting.size(), 0U);
}

}  // namespace
}  // namespace semantic_vslam
