// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/map/map.h"

#include <gtest/gtest.h>

#include "core/map/visibility.h"
#include "core/support/mapped_scene.h"

namespace semantic_vslam {
namespace {

using MapTest = MappedScene;

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
