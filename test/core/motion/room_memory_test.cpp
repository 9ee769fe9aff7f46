// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/motion/room_memory.h"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "core/support/quarter_vga.h"

namespace semantic_vslam {
namespace {

/// A wall 2 m before the camera, and at times somebody (or something) 1.2 m before it.
class RoomMemoryTest : public testing::Test {
 protected:
  static constexpr float kWallM = 2.0F, kNearM = 1.2F;

  /// @param label  what the semantic mask says of the visitor
  void see(double seconds, bool visited, bool keyframe, float label = 0.0F) {
    cv::Mat1b moving(grid.size(), static_cast<uchar>(0));
    cv::Mat1f semantic(grid.size(), 0.0F);
    if (visited) {
      moving(visitor) = static_cast<uchar>(200);
      semantic(visitor) = label;
    }
    const PlacedFrame place = frame(seconds, visited);
    memory.addFrame(place, place.depth_m, moving, semantic);
    const TimedPose pose{place.stamp, T_world_odometry * place.T_odometry_camera};
    if (keyframe) keyframes.push_back(pose);
    if (keyframe) memory.takeKeyframePoses(keyframes);
    memory.takeFramePose(pose);
  }
  PlacedFrame frame(double seconds, bool visited) const {
    cv::Mat1f depth_m(grid.size(), kWallM);
    if (visited) depth_m(visitor) = kNearM;
    return {Stamp::fromSeconds(seconds), depth_m, depth_m, T_odometry_camera};
  }
  /// Sees the same every half a second, a keyframe every second.
  void stay(double from_s, double to_s, bool visited, float label = 0.0F) {
    for (int i = 0; from_s + 0.5 * i < to_s; ++i) {
      see(from_s + 0.5 * i, visited, i % 2 == 0, label);
      for (int frame = 0; frame < 10; ++frame) look(from_s + 0.5 * i, visited);
    }
  }
  std::optional<RoomVote> look(double seconds, bool visited) {
    return memory.look(frame(seconds, visited), grid, rigid);
  }
  /// Rows take turns: any of three in a few looks.
  float entered(double seconds, bool visited, cv::Point cell) {
    float most = 0.0F;
    for (int turn = 0; turn < 3; ++turn) {
      const auto vote = look(seconds, visited);
      if (vote) most = std::max({most, vote->entered(cell), vote->entered(cell + cv::Point(0, 1))});
    }
    return most;
  }

  const WorkGrid grid{std::make_shared<const CameraModel>(quarterVga()), 160};
  const cv::Rect visitor{20, 10, 20, 40};
  const cv::Point on_visitor{30, 30}, on_wall{60, 30};
  const RigidFlowConfig rigid;
  RoomMemoryConfig config;
  RoomMemory memory{config};
  std::vector<TimedPose> keyframes;
  SE3 T_world_odometry = SE3::Identity(), T_odometry_camera = SE3::Identity();
};

TEST_F(RoomMemoryTest, WhoComesAndStopsIsNewHoweverLongAgoTheSpaceWasFree) {
  stay(0.0, 3.0, false);
  for (double seconds = 10.0; seconds < 25.0; seconds += 0.5) {
    see(seconds, true, false);
    EXPECT_FLOAT_EQ(entered(seconds, true, on_visitor), 1.0F) << seconds;
    EXPECT_FLOAT_EQ(entered(seconds, true, on_wall), 0.0F) << seconds;
  }
  const auto vote = look(25.0, true);
  ASSERT_TRUE(vote);
  EXPECT_FLOAT_EQ(std::max(vote->stayed(on_wall), vote->stayed(on_wall + cv::Point(0, 1))), 1.0F);
  EXPECT_FLOAT_EQ(std::max(vote->stayed(on_visitor), vote->stayed(on_visitor + cv::Point(0, 1))), 0.0F);
}

TEST_F(RoomMemoryTest, SaysNothingUntilItIsKnownWhereTheCameraStands) {
  const PlacedFrame place = frame(0.0, false);
  memory.addFrame(place, place.depth_m, cv::Mat1b::zeros(grid.size()), {});
  EXPECT_FALSE(look(0.1, true));
  memory.takeKeyframePoses({{place.stamp, SE3::Identity()}});
  EXPECT_TRUE(look(0.1, true));
  memory.breakOdometry();
  EXPECT_FALSE(look(0.2, true));
  EXPECT_EQ(memory.references(), 1U);
}

TEST_F(RoomMemoryTest, PoseOfAFrameThatIsNotKeptIsIgnored) {
  see(0.0, false, false);
  memory.takeKeyframePoses({{Stamp::fromSeconds(7.0), SE3::Identity()}});
  EXPECT_EQ(memory.references(), 0U);
}

TEST_F(RoomMemoryTest, HoldsAcrossALostAndFoundOdometry) {
  stay(0.0, 3.0, false);
  memory.breakOdometry();
  T_odometry_camera.translation() = Eigen::Vector3d(5.0, -2.0, 1.0);  // it starts anew from anywhere
  T_world_odometry = T_odometry_camera.inverse();
  see(30.0, true, false);
  EXPECT_FLOAT_EQ(entered(30.1, true, on_visitor), 1.0F);
  EXPECT_FLOAT_EQ(entered(30.1, true, on_wall), 0.0F);
}

TEST_F(RoomMemoryTest, ReferencesFollowTheMapAlsoWhereTheirKeyframeIsCulled) {
  stay(0.0, 3.0, false);
  SE3 T_after_before = SE3::Identity();
  T_after_before.translation().x() = 4.0;
  for (TimedPose& pose : keyframes) pose.T_world_camera = T_after_before * pose.T_world_camera;
  keyframes.erase(keyframes.begin() + 1);
  T_world_odometry = T_after_before;
  memory.takeKeyframePoses(keyframes);
  see(3.5, true, false);
  EXPECT_EQ(memory.references(), 3U);
  for (int i = 0; i < 4; ++i) {  // all of them have their turn
    EXPECT_FLOAT_EQ(entered(3.5, true, on_visitor), 1.0F);
    EXPECT_FLOAT_EQ(entered(3.5, true, on_wall), 0.0F);
  }
}

TEST_F(RoomMemoryTest, AnotherMapBeginsWithNothing) {
  stay(0.0, 3.0, false);
  keyframes.clear();
  see(3.5, false, true);
  EXPECT_EQ(memory.references(), 1U);
}

TEST_F(RoomMemoryTest, AChairPutDownBecomesFurnitureAfterTheStatedTime) {
  const double settle_s = config.settle_s;
  stay(0.0, 3.0, false);
  stay(3.0, 3.0 + 0.9 * settle_s, true);
  EXPECT_FLOAT_EQ(entered(3.0 + 0.9 * settle_s, true, on_visitor), 1.0F);
  // It is looked for now and then, one reference a frame.
  stay(3.0 + 0.9 * settle_s, 3.0 + 2.5 * settle_s, true);
  for (int i = 0; i < 30; ++i) EXPECT_FLOAT_EQ(entered(3.0 + 2.5 * settle_s, true, on_visitor), 0.0F);
}

TEST_F(RoomMemoryTest, APersonByALabelNeverBecomesFurniture) {
  const double settle_s = config.settle_s;
  stay(0.0, 3.0, false);
  stay(3.0, 3.0 + 2.5 * settle_s, true, 0.9F);
  EXPECT_FLOAT_EQ(entered(3.0 + 2.5 * settle_s, true, on_visitor), 1.0F);
}

TEST_F(RoomMemoryTest, WhoComesToTheSamePlaceAgainHasNotStoodThere) {
  const double settle_s = config.settle_s;
  stay(0.0, 3.0, false);
  for (int visit = 0; visit < 4; ++visit) {
    const double from_s = 3.0 + 0.6 * settle_s * visit;
    stay(from_s, from_s + 0.3 * settle_s, true);
    stay(from_s + 0.3 * settle_s, from_s + 0.6 * settle_s, false);
  }
  see(3.0 + 2.5 * settle_s, true, false);
  EXPECT_FLOAT_EQ(entered(3.0 + 2.5 * settle_s, true, on_visitor), 1.0F);
}

/// What the memory knows of the wall at rest, whose middle, or all of it, a network calls a person.
class LabelledWall : public RoomMemoryTest {
 protected:
  float known(double seconds, cv::Point at) {
    float most = 0.0F;
    for (int turn = 0; turn < 3; ++turn) most = std::max(most, look(seconds, false)->known(at));
    return most;
  }
  void seeForSeconds(const cv::Rect& person, int halves) {
    cv::Mat1f semantic(grid.size(), 0.0F);
    semantic(person).setTo(1.0F);
    for (int i = 0; i < halves; ++i) {
      const PlacedFrame place = frame(0.5 * i, false);
      memory.addFrame(place, place.depth_m, cv::Mat1b::zeros(grid.size()), semantic);
      keyframes.push_back({place.stamp, SE3::Identity()});
      memory.takeKeyframePoses(keyframes);
    }
  }
};

TEST_F(LabelledWall, IsKnownAfterSecondsWhereAllOfItIsCalledAPerson) {
  seeForSeconds({{}, grid.size()}, 4);
  EXPECT_FLOAT_EQ(known(1.5, on_wall), 0.0F) << "seen for a second and a half";
  keyframes.clear();
  memory.clear();
  seeForSeconds({{}, grid.size()}, 12);
  EXPECT_GT(known(5.6, on_wall), 0.0F);
  EXPECT_EQ(cv::countNonZero(look(5.6, false)->stayed), 0) << "nobody said that no person is there";
}

TEST_F(LabelledWall, IsNotKnownWhereSomebodySitsStill) {
  seeForSeconds(visitor, 12);
  EXPECT_FLOAT_EQ(known(5.6, on_visitor), 0.0F);
  EXPECT_GT(known(5.6, on_wall), 0.0F);
}

TEST_F(RoomMemoryTest, IsBounded) {
  const WorkGrid full(std::make_shared<const CameraModel>(CameraIntrinsics{640, 480, 525, 525, 319.5, 239.5, {}}), 320);
  const cv::Mat1f depth_m(full.size(), kWallM);
  const cv::Mat1b none = cv::Mat1b::zeros(full.size());
  for (int i = 0; i < 6000; ++i) {
    const PlacedFrame place{Stamp::fromSeconds(i / 30.0), depth_m, depth_m, SE3::Identity()};
    memory.addFrame(place, depth_m, none, {});
    if (i % 15 == 0) keyframes.push_back({place.stamp, SE3::Identity()});
    if (i % 15 == 0) memory.takeKeyframePoses(keyframes);
  }
  EXPECT_EQ(memory.references(), static_cast<std::size_t>(config.max_references));
  EXPECT_LE(memory.bytes(), 30U << 20U);
  EXPECT_GT(memory.bytes(), 1U << 20U);
}

}  // namespace
}  // namespace semantic_vslam
