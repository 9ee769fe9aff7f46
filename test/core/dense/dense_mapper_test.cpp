// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/dense/dense_mapper.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>

#include "dense_scene.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

DenseConfig smallConfig() {
  DenseConfig config;
  config.keyframe.stride_px = 1;
  config.keyframe.dynamic_margin_px = 0;
  config.voxels.resolution_m = 0.05;
  config.rebuild_keyframes_per_call = 1;
  return config;
}

SE3 translated(double x, double y, double z) {
  SE3 T = SE3::Identity();
  T.translation() = Eigen::Vector3d(x, y, z);
  return T;
}

bool addWall(DenseMapper& mapper, std::uint64_t id, const SE3& T_world_camera) {
  return mapper.add(KeyframeId(id), wallFrame(2.02F), cv::Mat1b(), cv::Mat1b(), T_world_camera);
}

cv::Vec3d mean(const std::vector<LabelledPoint>& cloud) {
  cv::Vec3d sum;
  for (const auto& point : cloud) sum += cv::Vec3d(point.xyz_m);
  return sum / static_cast<double>(cloud.size());
}

TEST(DenseMapper, CloudIsTheSurfaceInTheWorld) {
  DenseMapper mapper(smallConfig(), threeLabels());
  EXPECT_TRUE(mapper.cloud().empty());
  ASSERT_TRUE(addWall(mapper, 0, translated(1.0, 2.0, 3.0)));
  const auto cloud = mapper.cloud();
  ASSERT_GT(cloud.size(), 2900U);
  for (const auto& point : cloud) EXPECT_NEAR(point.xyz_m[2], 5.02, 1e-5);
  // Columns 0..63 around 32 and rows 0..47 around 24: the mean ray is (-0.5, -0.5) px from the axis.
  EXPECT_NEAR(mean(cloud)[0], 1.0 - 0.5 / 50 * 2.02, 2e-3);
  EXPECT_NEAR(mean(cloud)[1], 2.0 - 0.5 / 50 * 2.02, 2e-3);
}

TEST(DenseMapper, RefusesAFrameThatDoesNotFitAndAKnownId) {
  DenseMapper mapper(smallConfig(), threeLabels());
  const cv::Mat1b wrong_size(10, 10, std::uint8_t{0});
  EXPECT_FALSE(mapper.add(KeyframeId(0), wallFrame(2.0F), wrong_size, cv::Mat1b(), SE3::Identity()));
  EXPECT_FALSE(mapper.add(KeyframeId(0), wallFrame(2.0F), cv::Mat1b(), wrong_size, SE3::Identity()));
  EXPECT_FALSE(addWall(mapper, 0, translated(std::nan(""), 0, 0)));
  EXPECT_EQ(mapper.keyframes(), 0U);
  EXPECT_TRUE(addWall(mapper, 0, SE3::Identity()));
  EXPECT_FALSE(addWall(mapper, 0, SE3::Identity()));
}

TEST(DenseMapper, APoseOutOfReachIsLeftOutAndTheRestOfTheMapStays) {
  DenseMapper mapper(smallConfig(), threeLabels());
  ASSERT_TRUE(addWall(mapper, 0, SE3::Identity()));
  for (const double far_m : {20e3, -30e3, 1e300}) EXPECT_FALSE(addWall(mapper, 1, translated(far_m, 0, 0)));
  ASSERT_TRUE(addWall(mapper, 1, translated(1600.0, 0, 0))) << "OctoMap reaches 1638 m at 5 cm";
  ASSERT_TRUE(addWall(mapper, 2, translated(0.1, 0, 0)));
  mapper.updatePoses({{KeyframeId(0), Stamp(), SE3::Identity()},
                      {KeyframeId(1), Stamp(), translated(30e3, 0, 0)},
                      {KeyframeId(2), Stamp(), translated(0.1, 0, 0)}});
  mapper.finish();
  for (const LabelledPoint& point : mapper.cloud()) EXPECT_LT(std::abs(point.xyz_m[0]), 1638.0F);
  EXPECT_GT(mapper.cloud().size(), 2900U);
  EXPECT_LT(mapper.projectedMap(SE3::Identity()).cells.size(), 100'000'001U);
}

TEST(DenseMapper, APersonNeverEntersAndAMovedChairLeaves) {
  DenseMapper mapper(smallConfig(), threeLabels());
  const cv::Size size(64, 48);
  mapper.add(KeyframeId(0), wallFrame(2.02F), cv::Mat1b(size, std::uint8_t{1}), cv::Mat1b(), SE3::Identity());
  EXPECT_TRUE(mapper.cloud().empty());
  mapper.add(KeyframeId(1), wallFrame(1.02F), cv::Mat1b(size, std::uint8_t{2}), cv::Mat1b(), SE3::Identity());
  ASSERT_FALSE(mapper.cloud().empty());
  EXPECT_EQ(mapper.cloud().front().label, 2);
  for (std::uint64_t id = 2; id < 5; ++id) addWall(mapper, id, SE3::Identity());
  // Only the rim of the image, where a voxel reaches out of view, can still hold the chair.
  for (const auto& point : mapper.cloud()) {
    const bool rim = std::abs(point.xyz_m[0]) > 0.5 || std::abs(point.xyz_m[1]) > 0.35;
    EXPECT_TRUE(point.xyz_m[2] > 2.0F || rim) << point.xyz_m;
  }
}

/// A chair at 1 m before the wall, in the middle of the view.
RgbdFrame wallWithChair() {
  RgbdFrame frame = wallFrame(2.02F);
  frame.depth_m(cv::Rect(26, 18, 12, 12)) = 1.02F;
  return frame;
}

Occupancy chairIn(const DenseMapper& mapper) { return mapper.voxelMap().voxelAt({0.0, 0.0, 1.02}).state; }

TEST(DenseMapper, LooksBetweenKeyframesTakeAwayWhatIsGoneAndAddWhatCame) {
  DenseMapper mapper(smallConfig(), threeLabels());
  mapper.add(KeyframeId(0), wallWithChair(), {}, {}, SE3::Identity());
  ASSERT_EQ(chairIn(mapper), Occupancy::kOccupied);
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(mapper.look(KeyframeId(0), wallFrame(2.02F), {}, {}, SE3::Identity()));
  EXPECT_EQ(chairIn(mapper), Occupancy::kFree);
  for (int i = 0; i < 6; ++i) mapper.look(KeyframeId(0), wallWithChair(), {}, {}, SE3::Identity());
  EXPECT_EQ(chairIn(mapper), Occupancy::kOccupied);
  const std::vector<LabelledPoint> cloud = mapper.cloud();
  EXPECT_TRUE(std::any_of(cloud.begin(), cloud.end(), [](const auto& point) { return point.xyz_m[2] < 1.1F; }));
}

TEST(DenseMapper, ACameraThatStandsDoesNotMakeTheMapGrow) {
  DenseMapper mapper(smallConfig(), threeLabels());
  addWall(mapper, 0, SE3::Identity());
  for (std::size_t i = 0; i < DenseMapper::kLooks; ++i) {
    mapper.look(KeyframeId(0), wallFrame(2.02F), {}, {}, SE3::Identity());
  }
  const std::size_t bytes = mapper.memoryBytes();
  for (int i = 0; i < 50; ++i) mapper.look(KeyframeId(0), wallFrame(2.02F), {}, {}, SE3::Identity());
  EXPECT_EQ(mapper.memoryBytes(), bytes);
  EXPECT_EQ(mapper.keyframes(), 1U);
  EXPECT_EQ(mapper.views().size(), 1 + DenseMapper::kLooks);
}

TEST(DenseMapper, LooksMoveWithTheirKeyframeAndLastThroughARebuild) {
  DenseMapper mapper(smallConfig(), threeLabels());
  mapper.add(KeyframeId(0), wallWithChair(), {}, {}, SE3::Identity());
  for (int i = 0; i < 3; ++i) mapper.look(KeyframeId(0), wallFrame(2.02F), {}, {}, SE3::Identity());
  addWall(mapper, 1, translated(3.0, 0.0, 0.0));
  mapper.updatePoses(
      {{KeyframeId(0), Stamp{}, translated(0.0, 0.5, 0.0)}, {KeyframeId(1), Stamp{}, translated(3.0, 0.5, 0.0)}});
  mapper.finish();
  ASSERT_EQ(mapper.rebuilds(), 1U);
  EXPECT_EQ(mapper.voxelMap().voxelAt({0.0, 0.5, 1.02}).state, Occupancy::kFree);
  EXPECT_EQ(mapper.voxelMap().voxelAt({0.0, 0.5, 2.02}).state, Occupancy::kOccupied);
  for (const TimedPose& view : mapper.views()) EXPECT_DOUBLE_EQ(view.T_world_camera.translation().y(), 0.5);
}

TEST(DenseMapper, NothingIsLookedAtBeforeThereIsAKeyframe) {
  DenseMapper mapper(smallConfig(), threeLabels());
  EXPECT_FALSE(mapper.look(KeyframeId(0), wallFrame(2.02F), {}, {}, SE3::Identity()));
}

TEST(DenseMapper, ASmallChangeOfPoseIsIgnored) {
  DenseMapper mapper(smallConfig(), threeLabels());
  addWall(mapper, 0, SE3::Identity());
  mapper.updatePoses({{KeyframeId(0), Stamp{}, translated(0.009, 0, 0)}});
  EXPECT_FALSE(mapper.busy());
  EXPECT_EQ(mapper.rebuilds(), 0U);
}

TEST(DenseMapper, MovesTheMapExactlyAsThePosesMoved) {
  DenseMapper mapper(smallConfig(), threeLabels());
  addWall(mapper, 0, SE3::Identity());
  addWall(mapper, 1, translated(0.1, 0, 0));
  const cv::Vec3d before = mean(mapper.cloud());
  const SE3 T_new_old = translated(0.5, -0.25, 1.0);
  mapper.updatePoses(
      {{KeyframeId(0), Stamp{}, T_new_old}, {KeyframeId(1), Stamp{}, T_new_old * translated(0.1, 0, 0)}});
  // One keyframe a call: the old map is served until the new one is whole.
  EXPECT_TRUE(mapper.busy());
  EXPECT_LT(cv::norm(mean(mapper.cloud()) - before), 1e-9);
  mapper.finish();
  EXPECT_FALSE(mapper.busy());
  EXPECT_EQ(mapper.rebuilds(), 1U);
  EXPECT_LT(cv::norm(mean(mapper.cloud()) - before - cv::Vec3d(0.5, -0.25, 1.0)), 1e-5);
  EXPECT_EQ(mapper.voxelMap().voxelAt({0.5, -0.25, 3.02}).state, Occupancy::kOccupied);
  EXPECT_EQ(mapper.voxelMap().voxelAt({0.5, -0.25, 2.02}).state, Occupancy::kFree);
}

TEST(DenseMapper, ARotatedPoseTurnsThePoints) {
  DenseMapper mapper(smallConfig(), threeLabels());
  addWall(mapper, 0, SE3::Identity());
  SE3 quarter = SE3::Identity();
  quarter.linear() = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitY()).toRotationMatrix();
  mapper.updatePoses({{KeyframeId(0), Stamp{}, quarter}});
  mapper.finish();
  for (const auto& point : mapper.cloud()) EXPECT_NEAR(point.xyz_m[0], 2.02, 1e-5);  // z became x
}

TEST(DenseMapper, AKeyframeAddedDuringARebuildIsSeenAtOnceAmongTheOldPoses) {
  DenseMapper mapper(smallConfig(), threeLabels());
  for (std::uint64_t id = 0; id < 3; ++id) addWall(mapper, id, translated(0.1 * id, 0, 0));
  std::vector<KeyframePose> poses;
  for (std::uint64_t id = 0; id < 3; ++id) poses.push_back({KeyframeId(id), Stamp{}, translated(0.1 * id, 0, 1)});
  mapper.updatePoses(poses);  // adds one of three again
  ASSERT_TRUE(mapper.busy());
  addWall(mapper, 3, translated(0.0, 0.0, 2.0));
  ASSERT_TRUE(mapper.busy());
  EXPECT_EQ(mapper.voxelMap().voxelAt({0, 0, 3.02}).state,
            Occupancy::kOccupied);  // 1 m behind its neighbours, as it should
  EXPECT_EQ(mapper.voxelMap().voxelAt({0, 0, 4.02}).state, Occupancy::kUnknown);
  mapper.finish();
  EXPECT_EQ(mapper.voxelMap().voxelAt({0, 0, 4.02}).state, Occupancy::kOccupied);
  EXPECT_EQ(mapper.keyframes(), 4U);
}

TEST(DenseMapper, PosesThatMoveDuringARebuildAreTakenUpAfterIt) {
  DenseMapper mapper(smallConfig(), threeLabels());
  addWall(mapper, 0, SE3::Identity());
  addWall(mapper, 1, translated(0.1, 0, 0));
  const auto poses = [](double z) {
    return std::vector<KeyframePose>{{KeyframeId(0), Stamp{}, translated(0, 0, z)},
                                     {KeyframeId(1), Stamp{}, translated(0.1, 0, z)}};
  };
  mapper.updatePoses(poses(1.0));
  mapper.updatePoses(poses(2.0));
  mapper.finish();
  for (const auto& point : mapper.cloud()) EXPECT_NEAR(point.xyz_m[2], 4.02, 1e-5);
}

TEST(DenseMapper, ACulledKeyframeMovesWithItsNeighbour) {
  DenseMapper mapper(smallConfig(), threeLabels());
  addWall(mapper, 0, SE3::Identity());
  addWall(mapper, 1, translated(5.0, 0, 0));
  addWall(mapper, 2, translated(5.5, 0, 0));  // will be culled; next to 1
  mapper.updatePoses({{KeyframeId(0), Stamp{}, SE3::Identity()}, {KeyframeId(1), Stamp{}, translated(5.0, 1.0, 0)}});
  mapper.finish();
  EXPECT_EQ(mapper.keyframes(), 3U);
  float farthest_x = 0, farthest_y = 0;
  for (const auto& point : mapper.cloud()) {
    if (point.xyz_m[0] > farthest_x) farthest_x = point.xyz_m[0];
    if (point.xyz_m[0] > 5.0F) farthest_y = std::max(farthest_y, point.xyz_m[1]);
  }
  EXPECT_NEAR(farthest_x, 5.5 + 31 / 50.0 * 2.02, 0.01);
  EXPECT_NEAR(farthest_y, 1.0 + 23 / 50.0 * 2.02, 0.01);
}

TEST(DenseMapper, ACulledKeyframeStaysWithItsOwnVisitOfAPlace) {
  DenseMapper mapper(smallConfig(), threeLabels());
  addWall(mapper, 0, SE3::Identity());
  addWall(mapper, 1, translated(10.0, 0, 0));  // will be culled; nearest in space to 7
  addWall(mapper, 7, translated(10.1, 0, 0));
  addWall(mapper, 8, translated(0.1, 0, 0));  // will be culled; nearest in space to 0
  // A loop closing moves the second visit, 3 m along the wall: more than its 1.9 m in view.
  mapper.updatePoses({{KeyframeId(0), Stamp{}, SE3::Identity()}, {KeyframeId(7), Stamp{}, translated(10.1, 3.0, 0)}});
  mapper.finish();
  EXPECT_EQ(mapper.voxelMap().voxelAt({10.0, 0.0, 2.02}).state, Occupancy::kOccupied) << "1 stays with 0";
  EXPECT_EQ(mapper.voxelMap().voxelAt({0.1, 3.0, 2.02}).state, Occupancy::kOccupied) << "8 goes with 7";
}

/// A wall 2.025 m away as a Kinect sees it.
bool addKinectWall(DenseMapper& mapper, std::uint64_t id, const SE3& T_world_camera) {
  static const auto camera = std::make_shared<const CameraModel>(CameraIntrinsics());
  static const cv::Size size(camera->width(), camera->height());
  static const RgbdFrame frame =
      makeRgbdFrame(0, Stamp{1000}, cv::Mat3b(size, cv::Vec3b(10, 20, 30)), cv::Mat1f(size, 2.025F), 1.0, camera);
  return mapper.add(KeyframeId(id), frame, cv::Mat1b(), cv::Mat1b(), T_world_camera);
}

SE3 turned(double yaw_rad, double roll_rad) {
  SE3 T = SE3::Identity();
  T.linear() =
      (Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitY()) * Eigen::AngleAxisd(roll_rad, Eigen::Vector3d::UnitZ()))
          .toRotationMatrix();
  return T;
}

std::size_t keptBytes(const DenseMapper& mapper) { return mapper.memoryBytes() - mapper.voxelMap().memoryBytes(); }

/// Share of the voxels that a wall 2.025 m before the camera surely passes through which are not occupied.
double shareOfHoles(const VoxelMap& map, const SE3& T_world_camera) {
  int passed = 0, holes = 0;
  const SE3 T_camera_world = T_world_camera.inverse();
  for (double x = -1.1; x < 1.1; x += 0.01) {
    for (double y = -0.8; y < 0.8; y += 0.01) {
      const Eigen::Vector3d centre = map.centre(map.voxelAt(T_world_camera * Eigen::Vector3d(x, y, 2.025)).index);
      if (std::abs((T_camera_world * centre).z() - 2.025) > 0.2 * map.resolution()) continue;
      ++passed;
      if (map.voxelAt(centre).state != Occupancy::kOccupied) ++holes;
    }
  }
  return static_cast<double>(holes) / passed;
}

TEST(DenseMapper, ThinnedCloudsLeaveNoHolesInARebuiltMap) {
  constexpr int kKeyframes = 24;
  // Apart from each other, so that no keyframe fills the holes of another.
  const auto poseOf = [](int i) { return translated(5.0 * i, 0, 0) * turned(0.1 * i, 0.14 * i); };
  DenseConfig config;
  config.memory_mb = 4096;
  DenseMapper roomy(config, threeLabels());
  for (int i = 0; i < kKeyframes; ++i) ASSERT_TRUE(addKinectWall(roomy, i, poseOf(i)));
  // Three quarters of the clouds fit.
  config.memory_mb = static_cast<int>((keptBytes(roomy) * 3 / 4 + 2 * roomy.voxelMap().memoryBytes()) >> 20);
  DenseMapper mapper(config, threeLabels());
  std::vector<KeyframePose> poses;
  for (int i = 0; i < kKeyframes; ++i) {
    const SE3 T = poseOf(i);
    ASSERT_TRUE(addKinectWall(mapper, i, T));
    EXPECT_EQ(shareOfHoles(mapper.voxelMap(), T), 0.0) << "added, " << i;
    poses.push_back({KeyframeId(i), Stamp{}, translated(0, 0, 0.6) * T});
  }
  EXPECT_EQ(mapper.voxels(), roomy.voxels()) << "thinned only after it was added";
  EXPECT_EQ(mapper.keyframes(), roomy.keyframes());
  EXPECT_LE(keptBytes(mapper), keptBytes(roomy) * 3 / 4);
  mapper.updatePoses(poses);
  mapper.finish();
  ASSERT_EQ(mapper.rebuilds(), 1U);
  for (int i = 0; i < kKeyframes; ++i) {
    EXPECT_EQ(shareOfHoles(mapper.voxelMap(), poses[i].T_world_camera), 0.0) << "rebuilt, " << i;
  }
}

TEST(DenseMapper, KeepsToItsMemoryHoweverManyKeyframesAreCulled) {
  DenseConfig config;
  config.memory_mb = 8;  // 210 of the views alone
  config.keyframe.stride_px = 16;
  DenseMapper mapper(config, threeLabels());
  std::vector<KeyframePose> poses;
  for (std::uint64_t id = 0; id < 300; ++id) {
    ASSERT_TRUE(addKinectWall(mapper, id, SE3::Identity()));
    ASSERT_LE(keptBytes(mapper), 8U << 20) << id;
    // Every tenth stays; the newest is not culled before its time.
    while (!poses.empty() && poses.back().keyframe.value() % 10 != 0) poses.pop_back();
    if (id > 0) poses.push_back({KeyframeId(id - 1), Stamp{}, SE3::Identity()});
    mapper.updatePoses(poses);
  }
  EXPECT_LT(mapper.keyframes(), 210U);
  EXPECT_FALSE(mapper.cloud().empty());
  // Those that were not culled are all still there: a keyframe is refused only if it is known.
  for (std::uint64_t id = 0; id < 300; id += 10) EXPECT_FALSE(addKinectWall(mapper, id, SE3::Identity())) << id;
  EXPECT_FALSE(addKinectWall(mapper, 299, SE3::Identity()));
}

TEST(DenseMapper, AKnownPlaceTakesNoMoreMemoryWithTime) {
  DenseMapper mapper(smallConfig(), threeLabels());
  // Keyframe 0 saw a place that nobody comes to again; 1 and 2 stay of the place where the camera is for hours.
  const SE3 elsewhere = translated(20.0, 0, 0);
  std::vector<KeyframePose> poses = {{KeyframeId(0), Stamp{}, elsewhere}};
  addWall(mapper, 0, elsewhere);
  std::size_t bytes = 0;
  for (std::uint64_t id = 1; id < 100; ++id) {
    ASSERT_TRUE(addWall(mapper, id, SE3::Identity()));
    if (poses.back().keyframe.value() > 2) poses.pop_back();
    poses.push_back({KeyframeId(id), Stamp{}, SE3::Identity()});
    mapper.updatePoses(poses);
    ASSERT_LE(mapper.keyframes(), 12U) << "four that the sparse map has and two culled ones for each, " << id;
    if (id == 20) bytes = mapper.memoryBytes();
  }
  EXPECT_LE(mapper.memoryBytes(), bytes);
  EXPECT_TRUE(addWall(mapper, 50, SE3::Identity())) << "forgotten";
  EXPECT_FALSE(addWall(mapper, 98, SE3::Identity())) << "the newest that were culled are held";
  EXPECT_EQ(mapper.voxelMap().voxelAt({20.0, 0, 2.02}).state, Occupancy::kOccupied);
  EXPECT_EQ(mapper.voxelMap().voxelAt({0, 0, 2.02}).state, Occupancy::kOccupied);
}

TEST(DenseMapper, AForgottenKeyframeLeavesTheVoxelsAtTheNextRebuild) {
  DenseConfig config = smallConfig();
  config.memory_mb = 8;
  DenseMapper mapper(config, threeLabels());
  addWall(mapper, 0, SE3::Identity());
  addWall(mapper, 1, translated(20.0, 0, 0));
  addWall(mapper, 2, translated(10.0, 0, 0));
  mapper.updatePoses({{KeyframeId(0), Stamp{}, SE3::Identity()}, {KeyframeId(2), Stamp{}, translated(10.0, 0, 0)}});
  const auto reaches = [](const std::vector<LabelledPoint>& cloud) {
    return std::any_of(cloud.begin(), cloud.end(), [](const auto& point) { return point.xyz_m[0] > 15.0F; });
  };
  ASSERT_TRUE(reaches(mapper.cloud()));
  // 1 is the first that may go.
  for (std::uint64_t id = 3; id == mapper.keyframes(); ++id) addWall(mapper, id, SE3::Identity());
  EXPECT_FALSE(reaches(mapper.cloud()));
  EXPECT_EQ(mapper.voxelMap().voxelAt({20.0, 0, 2.02}).state, Occupancy::kOccupied);
  EXPECT_FALSE(mapper.busy());
  mapper.updatePoses({{KeyframeId(0), Stamp{}, translated(0, 1.0, 0)}});
  mapper.finish();
  EXPECT_EQ(mapper.voxelMap().voxelAt({20.0, 0, 2.02}).state, Occupancy::kUnknown);
  EXPECT_EQ(mapper.voxelMap().voxelAt({10.0, 0.5, 2.02}).state, Occupancy::kOccupied);
}

TEST(DenseMapper, WhatAKeyframeSawThatHadToGoStaysInTheVoxelsThroughRebuilds) {
  DenseConfig config = smallConfig();
  config.memory_mb = 8;
  DenseMapper mapper(config, threeLabels());
  addWall(mapper, 0, translated(20.0, 0, 0));
  // All held by the sparse map: of these the farthest must go.
  for (std::uint64_t id = 1; id == mapper.keyframes(); ++id) addWall(mapper, id, translated(0.001 * (id % 5), 0, 0));
  ASSERT_LT(mapper.memoryBytes(), 8U << 20);
  const auto seenThere = [&] { return mapper.voxelMap().voxelAt({20.0, 0, 2.02}); };
  const auto reaches = [](const std::vector<LabelledPoint>& cloud) {
    return std::any_of(cloud.begin(), cloud.end(), [](const auto& point) { return point.xyz_m[0] > 15.0F; });
  };
  ASSERT_EQ(seenThere().state, Occupancy::kOccupied);
  EXPECT_FALSE(reaches(mapper.cloud())) << "its points are gone";
  for (const double x : {0.1, 0.2}) {
    mapper.updatePoses({{KeyframeId(1), Stamp{}, translated(x, 0, 0)}, {KeyframeId(2), Stamp{}, translated(x, 0, 0)}});
    mapper.finish();
    EXPECT_EQ(seenThere().state, Occupancy::kOccupied) << x;
    EXPECT_EQ(mapper.evidenceAt({20.0, 0, 2.02}).last_seen.ns, 1000);
  }
  EXPECT_EQ(mapper.rebuilds(), 2U);
  mapper.clearBox({Eigen::Vector3d(18.0, -5.0, 0.0), Eigen::Vector3d(22.0, 5.0, 5.0)});
  EXPECT_EQ(seenThere().state, Occupancy::kUnknown);
}

TEST(DenseMapper, MemoryIsBoundedHoweverFarTheCameraGoes) {
  DenseConfig config;
  config.memory_mb = 16;
  const std::size_t most = std::size_t{16} << 20;
  DenseMapper mapper(config, threeLabels());
  std::vector<KeyframePose> poses;
  constexpr std::uint64_t kKeyframes = 40;
  for (std::uint64_t id = 0; id < kKeyframes; ++id) {
    const SE3 T = translated(3.0 * static_cast<double>(id), 0, 0);
    ASSERT_TRUE(addKinectWall(mapper, id, T));
    poses.push_back({KeyframeId(id), Stamp{}, T});
    ASSERT_LE(mapper.memoryBytes(), most) << id;
    if (id % 4 != 0) continue;
    mapper.cloud();
    mapper.fullOctree();
    mapper.projectedMap(SE3::Identity());
  }
  const double last_m = 3.0 * (kKeyframes - 1);
  EXPECT_EQ(mapper.voxelMap().voxelAt({last_m, 0, 2.025}).state, Occupancy::kOccupied);
  EXPECT_EQ(mapper.voxelMap().voxelAt({0.0, 0, 2.025}).state, Occupancy::kUnknown) << "too far away to be held";
  for (KeyframePose& pose : poses) pose.T_world_camera.translation().z() += 0.5;
  mapper.updatePoses(poses);
  while (mapper.busy()) {
    mapper.work();
    ASSERT_LE(mapper.memoryBytes(), most) << "a rebuild has two maps";
  }
  EXPECT_EQ(mapper.rebuilds(), 1U);
  EXPECT_EQ(mapper.voxelMap().voxelAt({last_m, 0, 2.525}).state, Occupancy::kOccupied);
  EXPECT_FALSE(mapper.cloud().empty());
}

bool samePoints(const std::vector<LabelledPoint>& a, const std::vector<LabelledPoint>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(LabelledPoint)) == 0;
}

TEST(DenseMapper, WhatIsPutTogetherFromPartsIsWhatIsMadeAnew) {
  DenseConfig config = smallConfig();
  config.grid.find_floor = false;
  config.grid.min_height_m = -0.5;
  config.grid.max_height_m = 1.0;
  config.grid.max_gap_m = 0.1;
  SE3 T_map_world = SE3::Identity();  // z up
  T_map_world.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    Rng rng(seed);
    DenseMapper mapper(config, threeLabels());
    std::vector<KeyframePose> poses;
    cv::Mat1b labels(48, 64, std::uint8_t{0});
    labels(cv::Rect(20, 10, 20, 20)) = 2;
    std::size_t points = 0, freed = 0;
    for (std::uint64_t step = 0; step < 30; ++step) {
      const std::uint64_t kind = rng.below(10);
      if (kind < 5 || poses.size() < 3) {
        poses.push_back({KeyframeId(step), Stamp{}, randomPose(rng)});
        mapper.add(KeyframeId(step), randomFrame(rng), labels, {}, poses.back().T_world_camera);
      } else if (kind < 7) {
        mapper.look(poses[rng.below(poses.size())].keyframe, randomFrame(rng), labels, {}, randomPose(rng));
      } else if (kind < 8) {
        poses.erase(poses.begin() + static_cast<std::ptrdiff_t>(rng.below(poses.size() - 1)));
        mapper.updatePoses(poses);
      } else if (kind < 9) {
        for (KeyframePose& pose : poses) pose.T_world_camera.translation().x() += 0.03 * rng.below(3);
        mapper.updatePoses(poses);
      } else {
        mapper.clearBox({Eigen::Vector3d(-0.5, -0.5, 1.0), Eigen::Vector3d(0.5, 0.5, 2.0)});
      }
      const std::vector<LabelledPoint> cloud = mapper.cloud();
      const OccupancyGrid grid = mapper.projectedMap(T_map_world);
      const OctreeMessage full = mapper.fullOctree(), binary = mapper.binaryOctree();
      points = std::max(points, cloud.size());
      freed = std::max<std::size_t>(freed, std::count(grid.cells.begin(), grid.cells.end(), OccupancyGrid::kFree));
      if (step % 3 != 2) continue;
      mapper.forgetParts();
      ASSERT_TRUE(samePoints(cloud, mapper.cloud())) << seed << ", " << step;
      ASSERT_EQ(full.data, mapper.fullOctree().data);
      ASSERT_EQ(binary.data, mapper.binaryOctree().data);
      const OccupancyGrid anew = mapper.projectedMap(T_map_world);
      ASSERT_EQ(grid.cells, anew.cells) << seed << ", " << step;
      ASSERT_EQ(grid.origin_x_m, anew.origin_x_m);
      ASSERT_EQ(grid.width, anew.width);
    }
    EXPECT_GT(points, 5000U);
    EXPECT_GT(freed, 50U);
  }
}

TEST(DenseMapper, ClearForgetsEverything) {
  DenseMapper mapper(smallConfig(), threeLabels());
  addWall(mapper, 0, SE3::Identity());
  mapper.clear();
  EXPECT_TRUE(mapper.cloud().empty());
  EXPECT_EQ(mapper.voxels(), 0U);
  EXPECT_EQ(mapper.keyframes(), 0U);
  EXPECT_TRUE(addWall(mapper, 0, SE3::Identity()));
}

TEST(DenseMapper, ABoxIsForgottenForGoodUntilItIsSeenAgain) {
  DenseMapper mapper(smallConfig(), threeLabels());
  addWall(mapper, 0, translated(1.0, 0, 0));
  const std::size_t before = mapper.cloud().size();
  mapper.clearBox({Eigen::Vector3d(-5.0, -5.0, 0.0), Eigen::Vector3d(1.0, 5.0, 5.0)});
  const auto only_right_half = [&] {
    for (const LabelledPoint& point : mapper.cloud()) EXPECT_GT(point.xyz_m[0], 0.95F);
    EXPECT_NEAR(static_cast<double>(mapper.cloud().size()), static_cast<double>(before) / 2.0, 150.0);
    EXPECT_NE(mapper.voxelMap().voxelAt({0.5, 0.0, 2.02}).state, Occupancy::kOccupied);
  };
  only_right_half();
  mapper.updatePoses({{KeyframeId(0), Stamp(), translated(1.0, 0, 1.0)}});
  mapper.finish();
  EXPECT_EQ(mapper.rebuilds(), 2U);
  only_right_half();
  addWall(mapper, 1, translated(1.0, 0, 1.0));
  EXPECT_GT(mapper.cloud().size(), before * 9 / 10);
}

TEST(DenseMapper, SavingToAPathThatCannotBeWrittenNamesItAndKeepsTheMap) {
  DenseMapper mapper(smallConfig(), threeLabels());
  addWall(mapper, 0, SE3::Identity());
  const std::string nowhere = "/nonexistent_folder/cloud.pcd";
  try {
    mapper.saveCloud(nowhere);
    FAIL() << "no error";
  } catch (const FileError& error) {
    EXPECT_NE(std::string(error.what()).find(nowhere), std::string::npos) << error.what();
  }
  EXPECT_THROW(mapper.saveOctomap("/nonexistent_folder/map.ot"), FileError);
  EXPECT_FALSE(mapper.cloud().empty());
}

/// Lets this process write files of so many bytes only, as on a disk that is nearly full, until it goes out of scope.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : old_handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &old_);
    const rlimit limit{bytes, old_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &old_);
    std::signal(SIGXFSZ, old_handler_);
  }

 private:
  void (*old_handler_)(int);
  rlimit old_{};
};

TEST(DenseMapper, ADiskThatFillsUpWhileSavingLeavesTheOldFile) {
  const std::string path = testing::TempDir() + "dense_mapper_test.pcd";
  DenseMapper mapper(smallConfig(), threeLabels());
  mapper.saveCloud(path);  // a header and no point
  addWall(mapper, 0, SE3::Identity());
  {
    const FileSizeLimit limit(10000);
    EXPECT_THROW(mapper.saveCloud(path), FileError);
  }
  std::ifstream file(path);
  const std::string content{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  EXPECT_NE(content.find("POINTS 0\n"), std::string::npos);
  EXPECT_FALSE(mapper.cloud().empty());
  std::remove(path.c_str());
}

TEST(DenseMapper, RefusesABadConfigurationByName) {
  DenseConfig config;
  config.voxels.hit_probability = 0.3;
  try {
    DenseMapper mapper(config, threeLabels());
    FAIL() << "no error";
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("voxels.hit_probability"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace semantic_vslam
