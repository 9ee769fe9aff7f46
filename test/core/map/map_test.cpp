// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/map/map.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/map/visibility.h"
#include "core/mapping/map_maintenance.h"
#include "core/support/point_scene.h"

namespace semantic_vslam {
namespace {

class MapTest : public ::testing::Test {
 protected:
  /// A keyframe that sees the scene, matched to the landmarks of the points it sees.
  KeyframeId addView(const SE3& T_camera_world) {
    std::vector<int> visible;
    TrackedFrame frame = scene_.frame(next_index_++, T_camera_world, 0.0, 0.0, &visible);
    frame.T_camera_world = T_camera_world;
    for (std::size_t i = 0; i < visible.size(); ++i) frame.landmarks[i] = landmark_of_point_[visible[i]];
    const KeyframeId id = insertKeyframe(map_, frame, SensorConfig(), MapMaintenanceConfig());
    for (std::size_t i = 0; i < visible.size(); ++i) {
      landmark_of_point_[visible[i]] = map_.keyframe(id)->landmarks[i];
    }
    return id;
  }

  PointScene scene_{300};
  std::vector<LandmarkId> landmark_of_point_ = std::vector<LandmarkId>(300);
  Map map_;
  std::uint64_t next_index_ = 0;
};

TEST_F(MapTest, AKeyframeMakesLandmarksWhereThePointsAre) {
  addView(cameraAt({0.1, 0, 0}, 0.05));
  ASSERT_GT(map_.landmarks().size(), 100U);
  for (int i = 0; i < 300; ++i) {
    const Landmark* landmark = map_.landmark(landmark_of_point_[i]);
    if (landmark == nullptr) continue;
    EXPECT_LT((landmark->position_world - scene_.points_world[i]).norm(), 1e-5);
  }
}

TEST_F(MapTest, CovisibilityCountsSharedLandmarksBothWays) {
  const KeyframeId a = addView(cameraAt({0, 0, 0}));
  const std::size_t seen_by_a = map_.landmarks().size();
  const KeyframeId b = addView(cameraAt({0.3, 0, 0}));
  int shared = 0;
  for (const auto& [id, landmark] : map_.landmarks()) {
    if (landmark.observations.size() == 2) ++shared;
  }
  EXPECT_GT(shared, 50);
  EXPECT_LT(shared, static_cast<int>(seen_by_a));
  ASSERT_EQ(map_.covisible(a, 1).size(), 1U);
  EXPECT_EQ(map_.covisible(a, 1)[0], std::make_pair(b, shared));
  EXPECT_EQ(map_.covisible(b, 1)[0], std::make_pair(a, shared));
  EXPECT_TRUE(map_.covisible(a, shared + 1).empty());
  EXPECT_EQ(map_.keyframe(b)->parent, a);
}

TEST_F(MapTest, RemovingAKeyframeReHangsItsChildrenAndKeepsSharedLandmarks) {
  const KeyframeId a = addView(cameraAt({0, 0, 0}));
  const KeyframeId b = addView(cameraAt({0.4, 0, 0}));
  const KeyframeId c = addView(cameraAt({0.8, 0, 0}));
  ASSERT_EQ(map_.keyframe(c)->parent, b);
  map_.removeKeyframe(b);
  EXPECT_EQ(map_.keyframe(b), nullptr);
  EXPECT_EQ(map_.keyframe(c)->parent, a);
  for (const auto& [id, landmark] : map_.landmarks()) {
    EXPECT_FALSE(landmark.observations.empty()) << id;
    EXPECT_EQ(landmark.observations.count(b), 0U);
    EXPECT_NE(landmark.reference_keyframe, b);
  }
  for (const auto& [other, count] : map_.covisible(a, 1)) {
    EXPECT_EQ(other, c);
  }
  map_.removeKeyframe(a);
  EXPECT_NE(map_.keyframe(a), nullptr) << "the first keyframe stays";
}

TEST_F(MapTest, RemovingATreeLeavesTheOthersAlone) {
  const KeyframeId a = addView(cameraAt({0, 0, 0}));
  const KeyframeId b = addView(cameraAt({0.1, 0, 0}));
  const std::size_t landmarks = map_.landmarks().size();
  landmark_of_point_.assign(300, LandmarkId());  // nothing is known again
  const KeyframeId c = addView(cameraAt({0, 0.1, 0}));
  const KeyframeId d = addView(cameraAt({0.1, 0.1, 0}));
  ASSERT_EQ(map_.rootOf(d), c);
  EXPECT_EQ(map_.removeTree(c), (std::vector<KeyframeId>{c, d}));
  EXPECT_EQ(map_.keyframes().size(), 2U);
  EXPECT_EQ(map_.landmarks().size(), landmarks);
  EXPECT_TRUE(map_.covisible(d, 1).empty());
  EXPECT_EQ(map_.rootOf(b), a);
}

TEST_F(MapTest, FusingLandmarksMovesTheirObservations) {
  const KeyframeId a = addView(cameraAt({0, 0, 0}));
  landmark_of_point_.assign(300, LandmarkId());  // b makes landmarks of its own
  const KeyframeId b = addView(cameraAt({0.1, 0, 0}));
  const LandmarkId from = map_.keyframe(b)->landmarks[0], into = map_.keyframe(a)->landmarks[0];
  const std::size_t before = map_.landmarks().size();
  map_.fuseLandmarks(from, into);
  EXPECT_EQ(map_.landmarks().size(), before - 1);
  EXPECT_EQ(map_.keyframe(b)->landmarks[0], into);
  EXPECT_EQ(map_.landmark(into)->observations.size(), 2U);
  EXPECT_EQ(map_.covisible(a, 1)[0].second, 1);
}

TEST_F(MapTest, DuplicatesOfANeighbourAreFound) {
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

TEST_F(MapTest, AStaleSolutionIsRefused) {
  const KeyframeId a = addView(cameraAt({0, 0, 0}));
  MapSolution solution;
  solution.T_camera_world[a] = cameraAt({1, 0, 0});
  const std::uint64_t version = map_.version();
  map_.bumpVersion();
  EXPECT_FALSE(map_.apply(solution, version));
  EXPECT_TRUE(map_.keyframe(a)->T_camera_world.isApprox(SE3::Identity()));
  EXPECT_TRUE(map_.apply(solution, map_.version()));
  EXPECT_TRUE(map_.keyframe(a)->T_camera_world.isApprox(cameraAt({1, 0, 0})));
}

TEST_F(MapTest, OutliersOfASolutionLoseTheirObservation) {
  const KeyframeId a = addView(cameraAt({0, 0, 0}));
  addView(cameraAt({0.1, 0, 0}));
  const LandmarkId landmark = map_.keyframe(a)->landmarks[3];
  MapSolution solution;
  solution.outlier_observations.emplace_back(a, landmark);
  EXPECT_TRUE(map_.apply(solution, map_.version()));
  EXPECT_FALSE(map_.keyframe(a)->landmarks[3].valid());
  EXPECT_EQ(map_.landmark(landmark)->observations.count(a), 0U);
}

TEST_F(MapTest, LandmarksThatNoSecondKeyframeSeesAreDroppedInTime) {
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

TEST_F(MapTest, LandmarksOnProbationThatAreRarelyFoundAreDropped) {
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

TEST_F(MapTest, AKeyframeThatAddsNothingIsRemovedAndAnnounced) {
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

TEST_F(MapTest, SightingsAreRefusedBehindAsideAndOutOfRange) {
  addView(cameraAt({0, 0, 0}));
  const Landmark& landmark = map_.landmarks().begin()->second;
  const Eigen::Vector3d p = landmark.position_world;
  Sighting sighting;
  EXPECT_TRUE(predictSighting(landmark, *scene_.camera, cameraAt({0, 0, 0}), 0.5, sighting));
  EXPECT_EQ(sighting.octave, 1) << "from where it was first seen it looks as it did";
  EXPECT_NEAR(sighting.depth_m, p.z(), 1e-9);
  EXPECT_FALSE(predictSighting(landmark, *scene_.camera, cameraAt({0, 0, p.z() + 1}), 0.5, sighting)) << "behind";
  EXPECT_FALSE(predictSighting(landmark, *scene_.camera, cameraAt({0, 0, -10}), 0.5, sighting)) << "too far";
  const SE3 from_behind = cameraAt({p.x(), p.y(), 2 * p.z()}, M_PI);
  EXPECT_FALSE(predictSighting(landmark, *scene_.camera, from_behind, 0.5, sighting)) << "seen from the other side";
}

}  // namespace
}  // namespace semantic_vslam
