// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/dense_stage.h"

#include <gtest/gtest.h>

#include "core/dense/dense_mapper.h"
#include "core/support/fixtures.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

MapSnapshot mapOf(std::uint32_t map_id, std::uint32_t origin, int keyframes) {
  MapSnapshot map;
  map.map_id = map_id;
  map.origin = origin;
  for (int i = 0; i < keyframes; ++i) {
    SE3 T = SE3::Identity();
    T.translation().x() = 0.1 * i;
    map.poses.push_back({KeyframeId(i), Stamp::fromSeconds(10.0 + i), T});
  }
  return map;
}

/// A wall in three keyframes of map 5.
void fill(DenseStage& stage) {
  stage.take(officeLabels());
  stage.take(mapOf(5, 0, 3));
  for (int i = 0; i < 3; ++i) {
    KeyframeInput input;
    input.keyframe = {KeyframeId(i), 5, Stamp::fromSeconds(10.0 + i)};
    input.frame = frameOf(cv::Mat1f(96, 128, 2.0F));
    input.frame.stamp = input.keyframe.stamp;
    stage.add(input);
  }
  ASSERT_EQ(stage.map().keyframes(), 3U);
}

DenseMapContent saved() {
  DenseStage stage({}, {});
  fill(stage);
  return stage.map().content(5);
}

TEST(DenseStage, ALoadedMapBringsItsDenseMap) {
  int asked = 0;
  DenseStage stage({}, {}, [&](std::uint32_t map_id) {
    ++asked;
    return map_id == 5 ? std::optional<DenseMapContent>(saved()) : std::nullopt;
  });
  stage.take(mapOf(9, 5, 3));
  EXPECT_EQ(stage.map().keyframes(), 3U);
  EXPECT_EQ(stage.labels().classes, officeLabels().classes);
  stage.take(mapOf(9, 5, 3));
  EXPECT_EQ(asked, 2) << "map 9 and its origin, once";
  stage.take(mapOf(10, 0, 1));
  EXPECT_EQ(stage.map().keyframes(), 0U) << "a new map begins empty";
}

TEST(DenseStage, TheMapStaysWhenTrackingComesBackWithIt) {
  DenseStage stage({}, {});
  fill(stage);
  stage.take(mapOf(9, 5, 3));
  EXPECT_EQ(stage.map().keyframes(), 3U);
  stage.take(mapOf(12, 5, 3));
  EXPECT_EQ(stage.map().keyframes(), 3U) << "a second time";
  stage.take(mapOf(13, 0, 3));
  EXPECT_EQ(stage.map().keyframes(), 0U) << "another map";
}

/// The map that comes back may be a little older than what is held: the numbers of the newest are given anew.
TEST(DenseStage, KeyframesThatTheMapLostMakeRoomForThoseThatGetTheirNumbers) {
  DenseStage stage({}, {});
  fill(stage);
  stage.take(mapOf(9, 5, 2));
  EXPECT_EQ(stage.map().keyframes(), 2U);
  KeyframeInput again;
  again.keyframe = {KeyframeId(2), 9, Stamp::fromSeconds(20.0)};
  again.frame = frameOf(cv::Mat1f(96, 128, 2.0F));
  again.frame.stamp = again.keyframe.stamp;
  stage.add(again);
  stage.take(mapOf(9, 5, 3));
  EXPECT_EQ(stage.map().keyframes(), 3U);
  EXPECT_EQ(stage.map().content(9).keyframes.back().cloud.stamp, again.frame.stamp);

  DenseStage fresh({}, {}, [](std::uint32_t map_id) {
    return map_id == 5 ? std::optional<DenseMapContent>(saved()) : std::nullopt;
  });
  fresh.take(mapOf(9, 5, 2));
  EXPECT_EQ(fresh.map().keyframes(), 2U);
}

TEST(DenseStage, WhatHasLabelsStaysWhereNobodyLabelsAnyMore) {
  DenseStage stage({}, {});
  fill(stage);
  stage.take(LabelSet());
  EXPECT_EQ(stage.map().keyframes(), 3U);
  EXPECT_EQ(stage.labels().classes, officeLabels().classes);
  LabelSet other = officeLabels();
  other.classes.pop_back();
  stage.take(other);
  EXPECT_EQ(stage.map().keyframes(), 0U);
}

TEST(DenseStage, AnEmptyMapIsNotSaved) {
  const DenseStage stage({}, {});
  EXPECT_THROW(stage.save(testing::TempDir() + "empty.dense"), Error);
}

}  // namespace
}  // namespace semantic_vslam
