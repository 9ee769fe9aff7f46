// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/mapping/map_maintenance.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/support/mapped_scene.h"

namespace semantic_vslam {
namespace {

using MapMaintenanceTest = MappedScene;

TEST_F(MapMaintenanceTest, AKeyframeMakesLandmarksWhereThePointsAre) {
  addView(cameraAt({0.1, 0, 0}, 0.05));
  ASSERT_GT(map_.landmarks().size(), 100U);
  for (int i = 0; i < 300; ++i) {
    const Landmark* landmark = map_.landmark(landmark_of_point_[i]);
    if (landmark == nullptr) continue;
    EXPECT_LT((landmark->position_world - scene_.points_world[i]).norm(), 1e-5);
  }
}

TEST_F(MapMaintenanceTest, DuplicatesOfANeighbourAreFound) {
  addView(cameraAt({0, 0, 0}));
  const std::size_t once = map_.landmarks().size();
  const auto first = landmark_of_point_;
  landmark_of_point_.assign(300, LandmarkId());
  for (int i = 0; i < 30; ++i) landmark_of_point_[i] = first[i];  // enough to be neighbours
  const KeyframeId b = addView(cameraAt({0.05, 0, 0}));
  ASSERT_GT(map_.landmarks().size(), once + 100);
  fuseWithNeighbours(map_, b, SensorConfig().virtual_baseline_m, MapMaintenanceConfig());
  EXPECT_LT(map_.landmarks().size(), once + 30) << "nearly all duplicates are merged";
}

TEST_F(MapMaintenanceTest, LandmarksThatNoSecondKeyframeSeesAreDroppedInTime) {
  // All from one place, where all see the same points; those forgotten are new to the next view.
  const auto forget_every = [&](int nth) {
    std::vector<LandmarkId> forgotten;
    for (int i = 0; i < 300; i += nth) {
      if (landmark_of_point_[i].valid()) forgotten.push_back(landmark_of_point_[i]);
      landmark_of_point_[i] = LandmarkId();
    }
    return forgotten;
  };
  const auto cull = [&](KeyframeId newest) { return cullRecentLandmarks(map_, newest, MapMaintenanceConfig()); };
  const auto held = [&](const std::vector<LandmarkId>& ids) {
    return std::count_if(ids.begin(), ids.end(), [&](LandmarkId id) { return map_.landmark(id) != nullptr; });
  };
  addView(cameraAt({0, 0, 0}));
  const auto seen_by_first = forget_every(4);
  ASSERT_GT(seen_by_first.size(), 30U);
  EXPECT_EQ(cull(addView(cameraAt({0, 0, 0}))), 0) << "too early";
  const auto seen_by_second = forget_every(8);
  const KeyframeId third = addView(cameraAt({0, 0, 0}));
  const std::size_t before = map_.landmarks().size();
  EXPECT_EQ(cull(third), static_cast<int>(seen_by_first.size()));
  EXPECT_EQ(held(seen_by_first), 0);
  EXPECT_EQ(map_.landmarks().size(), before - seen_by_first.size()) << "others stay";
  EXPECT_EQ(cull(addView(cameraAt({0, 0, 0}))), static_cast<int>(seen_by_second.size()));
  EXPECT_EQ(held(seen_by_second), 0);
  EXPECT_EQ(cull(addView(cameraAt({0, 0, 0}))), 0) << "all that are left are confirmed";
}

TEST_F(MapMaintenanceTest, LandmarksOnProbationThatAreRarelyFoundAreDropped) {
  std::vector<LandmarkId> made_in;  // one of each keyframe
  for (int i = 0; i < 5; ++i) {
    for (int point = i; point < 300; point += 5) landmark_of_point_[point] = LandmarkId();  // new to this view
    const KeyframeId keyframe = addView(cameraAt({0, 0, 0}));
    const auto& seen = map_.keyframe(keyframe)->landmarks;
    made_in.push_back(*std::find_if(seen.begin(), seen.end(),
                                    [&](LandmarkId id) { return map_.landmark(id)->created_in == keyframe; }));
  }
  landmark_of_point_.assign(300, LandmarkId());
  const KeyframeId elsewhere = addView(cameraAt({0, 0, 0}));
  made_in.push_back(map_.keyframe(elsewhere)->landmarks[0]);
  const auto find_once_of_five_times = [&](LandmarkId id) {
    for (int i = 0; i < 4; ++i) map_.countVisible(id);
  };
  for (const int i : {0, 1, 5}) find_once_of_five_times(made_in[i]);
  cullRecentLandmarks(map_, KeyframeId(4), MapMaintenanceConfig());
  EXPECT_NE(map_.landmark(made_in[0]), nullptr) << "its probation is over";
  EXPECT_EQ(map_.landmark(made_in[1]), nullptr);
  EXPECT_NE(map_.landmark(made_in[5]), nullptr) << "newer than the keyframe";
  find_once_of_five_times(made_in[3]);
  cullRecentLandmarks(map_, elsewhere, MapMaintenanceConfig());
  EXPECT_NE(map_.landmark(made_in[3]), nullptr) << "of another tree, which this keyframe cannot see";
  EXPECT_EQ(map_.landmark(made_in[5]), nullptr);
}

TEST_F(MapMaintenanceTest, AKeyframeThatAddsNothingIsRemovedAndAnnounced) {
  std::vector<KeyframeId> ids;
  for (int i = 0; i < 6; ++i) ids.push_back(addView(cameraAt({0.01 * i, 0, 0})));
  std::vector<KeyframeId> announced;
  const int removed = cullRedundantKeyframes(map_, ids.back(), KeyframeId(), SensorConfig(), MapMaintenanceConfig(),
                                             [&](const Keyframe& gone) { announced.push_back(gone.id); });
  EXPECT_EQ(removed, 3) << "of six that see the same, three stay: the fourth still had three others";
  EXPECT_EQ(announced.size(), 3U);
  EXPECT_NE(map_.keyframe(ids.front()), nullptr);
  EXPECT_NE(map_.keyframe(ids.back()), nullptr);
}

}  // namespace
}  // namespace semantic_vslam
