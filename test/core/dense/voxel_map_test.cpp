// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/dense/voxel_map.h"

#include <gtest/gtest.h>

#include <cmath>

#include "dense_scene.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

VoxelMapConfig coarse() {
  VoxelMapConfig config;
  config.resolution_m = 0.1;
  return config;
}

/// Adds a frame as it would be added by the mapper, every pixel a point.
void look(VoxelMap& map, const RgbdFrame& frame, const SE3& T_world_camera = SE3::Identity(),
          const cv::Mat1b& excluded = cv::Mat1b(), const cv::Mat1b& labels = cv::Mat1b()) {
  KeyframeCloudConfig config;
  config.stride_px = 1;
  const auto cloud = makeKeyframeCloud(KeyframeId(0), frame, labels, excluded, config);
  map.integrate(cloud.points, makeFreeSpaceView(frame, excluded, excluded, config, 2), T_world_camera);
}

/// A wall at 3 m with a 0.4 m wide thing in the middle of the view at 1.5 m.
RgbdFrame wallWithThing() {
  RgbdFrame frame = wallFrame(3.0F);
  frame.depth_m(cv::Rect(25, 17, 14, 14)) = 1.55F;
  return frame;
}

TEST(VoxelMap, KnowsSurfaceFreeSpaceAndWhatLiesBehind) {
  VoxelMap map(coarse());
  look(map, wallFrame(2.05F));
  EXPECT_EQ(map.voxelAt({0.0, 0.0, 2.05}).state, Occupancy::kOccupied);
  EXPECT_EQ(map.voxelAt({0.0, 0.0, 1.0}).state, Occupancy::kFree);
  EXPECT_EQ(map.voxelAt({0.3, -0.3, 1.5}).state, Occupancy::kFree);
  EXPECT_EQ(map.voxelAt({0.0, 0.0, 2.25}).state, Occupancy::kUnknown);  // behind
  EXPECT_EQ(map.voxelAt({3.0, 0.0, 1.0}).state, Occupancy::kUnknown);   // beside the view
  EXPECT_EQ(map.voxelAt({0.0, 0.0, -0.5}).state, Occupancy::kUnknown);  // behind the camera
  EXPECT_EQ(map.voxelAt({1e9, 0.0, 0.0}).state, Occupancy::kUnknown);
}

TEST(VoxelMap, SumsLogOddsOfKeyframesAndClampsThem) {
  VoxelMap map(coarse());
  const double hit = std::log(0.7 / 0.3), miss = std::log(0.35 / 0.65);
  const Eigen::Vector3d on_wall(0.0, 0.0, 2.05), in_air(0.0, 0.0, 1.0);
  look(map, wallFrame(2.05F));
  EXPECT_NEAR(map.voxelAt(on_wall).log_odds, hit, 1e-3);
  EXPECT_NEAR(map.voxelAt(in_air).log_odds, miss, 1e-3);
  look(map, wallFrame(2.05F));
  EXPECT_NEAR(map.voxelAt(on_wall).log_odds, 2 * hit, 1e-3);
  EXPECT_NEAR(map.voxelAt(in_air).log_odds, 2 * miss, 1e-3);
  EXPECT_EQ(map.voxelAt(on_wall).hits, 2);
  for (int i = 0; i < 10; ++i) look(map, wallFrame(2.05F));
  EXPECT_NEAR(map.voxelAt(on_wall).log_odds, std::log(0.97 / 0.03), 1e-3);
  EXPECT_NEAR(map.voxelAt(in_air).log_odds, std::log(0.12 / 0.88), 1e-3);
}

TEST(VoxelMap, FreeSpaceEndsAtItsRange) {
  VoxelMapConfig config = coarse();
  config.free_range_m = 1.5;
  VoxelMap map(config);
  look(map, wallFrame(3.05F));
  EXPECT_EQ(map.voxelAt({0.0, 0.0, 1.35}).state, Occupancy::kFree);
  EXPECT_EQ(map.voxelAt({0.0, 0.0, 1.65}).state, Occupancy::kUnknown);
}

TEST(VoxelMap, FollowsTheCameraPose) {
  VoxelMap map(coarse());
  // The camera at (1, 0, 0) looks along -x of the world: its z is -x, its x is +z, its y is +y.
  SE3 T_world_camera = SE3::Identity();
  T_world_camera.linear() << 0, 0, -1, 0, 1, 0, 1, 0, 0;
  T_world_camera.translation() = Eigen::Vector3d(1.0, 0.0, 0.0);
  look(map, wallFrame(2.05F), T_world_camera);
  EXPECT_EQ(map.voxelAt({-1.05, 0.0, 0.0}).state, Occupancy::kOccupied);
  EXPECT_EQ(map.voxelAt({0.0, 0.0, 0.0}).state, Occupancy::kFree);
  EXPECT_EQ(map.voxelAt({0.0, 0.0, 2.05}).state, Occupancy::kUnknown);
}

TEST(VoxelMap, LaterViewsThroughAWalkerRemoveHim) {
  VoxelMap map(coarse());
  look(map, wallWithThing());
  ASSERT_EQ(map.voxelAt({0.0, 0.0, 1.55}).state, Occupancy::kOccupied);
  look(map, wallFrame(3.05F));
  EXPECT_NE(map.voxelAt({0.0, 0.0, 1.55}).state,
            Occupancy::kOccupied);  // one point, one view through: not shown any more
  look(map, wallFrame(3.05F));
  look(map, wallFrame(3.05F));
  EXPECT_EQ(map.voxelAt({0.0, 0.0, 1.55}).state, Occupancy::kFree);
  EXPECT_EQ(map.voxelAt({0.0, 0.0, 3.05}).state, Occupancy::kOccupied);
}

TEST(VoxelMap, AWalkerBeforeSeenSpaceNeverShows) {
  VoxelMap map(coarse());
  for (int i = 0; i < 3; ++i) look(map, wallFrame(3.05F));
  look(map, wallWithThing());
  EXPECT_NE(map.voxelAt({0.0, 0.0, 1.55}).state, Occupancy::kOccupied);
}

TEST(VoxelMap, ExcludedPixelsNeitherHitNorFree) {
  VoxelMap map(coarse());
  const RgbdFrame frame = wallWithThing();
  cv::Mat1b excluded(frame.depth_m.size(), std::uint8_t{0});
  excluded(cv::Rect(23, 15, 18, 18)) = 255;
  look(map, frame, SE3::Identity(), excluded);
  EXPECT_EQ(map.voxelAt({0.0, 0.0, 1.55}).state, Occupancy::kUnknown);
  EXPECT_EQ(map.voxelAt({0.0, 0.0, 1.0}).state, Occupancy::kUnknown);  // no ray towards the person either
  EXPECT_EQ(map.voxelAt({0.35, 0.0, 0.85}).state, Occupancy::kFree);   // beside
}

TEST(VoxelMap, FreeSpaceDoesNotEatTheSilhouetteOfANearThing) {
  VoxelMap map(coarse());
  for (int i = 0; i < 5; ++i) look(map, wallWithThing());
  // The thing spans x = (25 - 32 .. 38 - 32) / 50 * 1.55 = -0.217 .. 0.186 m; its outline voxels stay.
  for (const double x : {-0.15, -0.05, 0.05, 0.15}) {
    EXPECT_EQ(map.voxelAt({x, 0.0, 1.55}).state, Occupancy::kOccupied) << x;
  }
}

TEST(VoxelMap, FusesColourAndLabelOverKeyframes) {
  VoxelMap map(coarse());
  const cv::Size size(64, 48);
  const cv::Mat1b chair(size, std::uint8_t{2}), background(size, std::uint8_t{0});
  look(map, wallFrame(2.05F, {10, 100, 200}), SE3::Identity(), cv::Mat1b(), background);
  look(map, wallFrame(2.05F, {20, 110, 220}), SE3::Identity(), cv::Mat1b(), chair);
  look(map, wallFrame(2.05F, {30, 120, 240}), SE3::Identity(), cv::Mat1b(), chair);
  const Voxel voxel = map.voxelAt({0.0, 0.0, 2.05});
  EXPECT_EQ(voxel.label, 2);
  EXPECT_NEAR(voxel.bgr[0], 20, 1);
  EXPECT_NEAR(voxel.bgr[1], 110, 1);
  EXPECT_NEAR(voxel.bgr[2], 220, 1);
}

TEST(VoxelMap, GoesAfterThreeViewsThroughHoweverOftenItWasSeen) {
  VoxelMap map(coarse());
  for (int i = 0; i < 20; ++i) look(map, wallWithThing());
  for (int i = 0; i < 2; ++i) look(map, wallFrame(3.05F));
  EXPECT_EQ(map.voxelAt({0.0, 0.0, 1.55}).state, Occupancy::kOccupied);
  look(map, wallFrame(3.05F));
  EXPECT_EQ(map.voxelAt({0.0, 0.0, 1.55}).state, Occupancy::kFree);
}

TEST(VoxelMap, WhatIsSeenOnceBeforeSomethingThatReturnsNoLightGoesWhenItIsSeenNoMore) {
  VoxelMap map(coarse());
  RgbdFrame black_screen = wallFrame(3.05F);
  black_screen.depth_m(cv::Rect(20, 12, 24, 24)) = 0.0F;
  RgbdFrame someone = black_screen;
  someone.depth_m = black_screen.depth_m.clone();
  someone.depth_m(cv::Rect(25, 17, 14, 14)) = 1.55F;
  look(map, someone);
  EXPECT_EQ(map.voxelAt({0.0, 0.0, 1.55}).state, Occupancy::kOccupied);
  for (int i = 0; i < 3; ++i) look(map, black_screen);
  EXPECT_NE(map.voxelAt({0.0, 0.0, 1.55}).state, Occupancy::kOccupied);
}

TEST(VoxelMap, WhatMostViewsKnowForAPersonIsNotShownThoughSomeViewsTookHimForAThing) {
  VoxelMap map(coarse());
  const RgbdFrame frame = wallWithThing();
  cv::Mat1b person(frame.depth_m.size(), std::uint8_t{0});
  person(cv::Rect(23, 15, 18, 18)) = 255;
  look(map, frame);
  ASSERT_EQ(map.voxelAt({0.0, 0.0, 1.55}).state, Occupancy::kOccupied);
  look(map, frame, SE3::Identity(), person);
  EXPECT_EQ(map.voxelAt({0.0, 0.0, 1.55}).state, Occupancy::kUnknown) << "known later: corrected";
  look(map, frame);
  EXPECT_EQ(map.voxelAt({0.0, 0.0, 1.55}).state, Occupancy::kUnknown);
  EXPECT_EQ(map.voxelAt({0.9, 0.0, 3.05}).state, Occupancy::kOccupied) << "the wall beside him";
}

TEST(VoxelMap, AThingIsShownWhereAPersonStoodBefore) {
  VoxelMap map(coarse());
  const RgbdFrame frame = wallWithThing();
  cv::Mat1b person(frame.depth_m.size(), std::uint8_t{0});
  person(cv::Rect(23, 15, 18, 18)) = 255;
  for (int i = 0; i < 5; ++i) look(map, frame, SE3::Identity(), person);
  look(map, wallFrame(3.05F));  // he has gone
  for (int i = 0; i < 2; ++i) look(map, frame);
  EXPECT_EQ(map.voxelAt({0.0, 0.0, 1.55}).state, Occupancy::kOccupied);
}

/// A wall at 2.05 m whose depth in each frame is off by some centimetres, more often before than behind.
std::vector<float> noisyWall() { return {2.01F, 2.09F, 2.03F, 2.06F, 2.05F, 2.02F, 2.08F, 2.06F}; }

TEST(VoxelMap, ManyViewsOfAWallAreOneSurface) {
  VoxelMapConfig config;
  config.resolution_m = 0.03;
  VoxelMap map(config);
  for (const float depth_m : noisyWall()) look(map, wallFrame(depth_m));
  int layers = 0;
  for (double z_m = 1.9; z_m < 2.2; z_m += 0.03) {
    if (map.voxelAt({0.0, 0.0, z_m}).state == Occupancy::kOccupied) ++layers;
  }
  EXPECT_GE(layers, 1);
  EXPECT_LE(layers, 2);
  LabelledPoint point{cv::Vec3f(0.1F, -0.1F, 2.09F), {}, 0};
  ASSERT_TRUE(VoxelMap::SurfaceReader(map).moveOntoSurface(point, 0.08));
  EXPECT_NEAR(point.xyz_m[2], 2.05F, 0.004F);
  EXPECT_NEAR(point.xyz_m[0], 0.1F, 0.001F);
  EXPECT_FALSE(VoxelMap::SurfaceReader(map).moveOntoSurface(point = {cv::Vec3f(0.1F, -0.1F, 2.09F), {}, 0},
                                                            0.02));  // too far off to be of it
}

TEST(VoxelMap, NearViewsCountMoreThanFarOnes) {
  VoxelMapConfig config;
  config.resolution_m = 0.03;
  VoxelMap map(config);
  SE3 back = SE3::Identity();
  back.translation().z() = -2.4;
  for (int i = 0; i < 3; ++i) look(map, wallFrame(3.44F), back);  // the wall at 1.04 m, as seen from 3.44 m
  look(map, wallFrame(1.00F));
  LabelledPoint point{cv::Vec3f(0.0F, 0.0F, 1.01F), {}, 0};
  ASSERT_TRUE(VoxelMap::SurfaceReader(map).moveOntoSurface(point, 0.05));
  EXPECT_NEAR(point.xyz_m[2], 1.00F, 0.006F);
}

TEST(VoxelMap, ListsEachKnownVoxelOnceInAFixedOrder) {
  VoxelMap map(coarse());
  look(map, wallWithThing());
  std::size_t known = 0;
  map.forEachKnown([&](const Voxel& voxel) {
    ++known;
    EXPECT_EQ(map.voxel(voxel.index).log_odds, voxel.log_odds);
    EXPECT_EQ(map.voxelAt(map.centre(voxel.index)).state, voxel.state);
  });
  EXPECT_LE(known, map.size());  // noise beside a surface is neither free nor occupied
  EXPECT_GT(known, 1000U);
}

TEST(VoxelMap, RefusesABadConfiguration) {
  VoxelMapConfig config;
  config.resolution_m = 0.0;
  EXPECT_THROW(VoxelMap{config}, ConfigError);
}

}  // namespace
}  // namespace semantic_vslam
