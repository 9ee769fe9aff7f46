// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/tracking/tracker.h"

#include <gtest/gtest.h>

#include "core/mapping/map_maintenance.h"
#include "core/support/point_scene.h"
#include "core/tracking/trajectory_log.h"

namespace semantic_vslam {
namespace {

double positionError(const SE3& a, const SE3& b) {
  return (a.inverse().translation() - b.inverse().translation()).norm();
}

TEST(FrameTracker, RecoversAKnownMotionFromTheLastFrame) {
  PointScene scene(400);
  TrackedFrame last = scene.frame(0, cameraAt({0, 0, 0}), 0.3, 0.002);
  const SE3 truth = cameraAt({0.03, -0.01, 0.02}, 0.01);
  TrackedFrame current = scene.frame(1, truth, 0.3, 0.002);
  const PoseEstimate estimate = trackFromLastFrame(Map(), last, SE3::Identity(), FrameTrackerConfig(), current);
  ASSERT_TRUE(estimate.success);
  EXPECT_GT(estimate.inliers, 200);
  EXPECT_LT(positionError(current.T_camera_world, truth), 0.002);
  EXPECT_LT(rotationAngle(current.T_camera_world * truth.inverse()), 0.002);
}

TEST(FrameTracker, FailsWithoutMatches) {
  PointScene scene(400), other(400, 2);
  TrackedFrame last = scene.frame(0, cameraAt({0, 0, 0}));
  TrackedFrame current = other.frame(1, cameraAt({0, 0, 0}));
  EXPECT_FALSE(trackFromLastFrame(Map(), last, SE3::Identity(), FrameTrackerConfig(), current).success);
}

TEST(Initializer, TakesTwoFramesThatAgree) {
  PointScene scene(400);
  Initializer initializer{InitializerConfig(), FrameTrackerConfig()};
  TrackedFrame k1 = scene.frame(0, cameraAt({0, 0, 0})), k2 = scene.frame(1, cameraAt({0.02, 0, 0}));
  EXPECT_FALSE(initializer.offer(k1));
  const auto first = initializer.offer(k2);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->index, 0U);
  EXPECT_LT(positionError(k2.T_camera_world, cameraAt({0.02, 0, 0})), 1e-4);
}

TEST(Initializer, ReleasesK1WhenK2DoesNotMatchAndGoesOnFromK2) {
  PointScene scene(400), other(400, 2);
  Initializer initializer{InitializerConfig(), FrameTrackerConfig()};
  TrackedFrame stranger = other.frame(0, cameraAt({0, 0, 0}));
  TrackedFrame k1 = scene.frame(1, cameraAt({0, 0, 0})), k2 = scene.frame(2, cameraAt({0.02, 0, 0}));
  EXPECT_FALSE(initializer.offer(stranger));
  EXPECT_FALSE(initializer.offer(k1));
  const auto first = initializer.offer(k2);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->index, 1U);
}

TEST(Initializer, AFrameWithTooFewPointsIsNoK1) {
  PointScene scene(60);
  Initializer initializer{InitializerConfig(), FrameTrackerConfig()};
  TrackedFrame a = scene.frame(0, cameraAt({0, 0, 0})), b = scene.frame(1, cameraAt({0, 0, 0}));
  EXPECT_FALSE(initializer.offer(a));
  EXPECT_FALSE(initializer.offer(b));
}

class TrackerTest : public ::testing::Test {
 protected:
  /// Runs the tracker on one frame the way its owner does.
  TrackingResult feed(const TrackedFrame& frame) {
    TrackingResult result = tracker_.track(frame, map_, true);
    if (result.first_frame) {
      TrackedFrame first = *result.first_frame;
      const KeyframeId id = insertKeyframe(map_, first, SensorConfig(), MapMaintenanceConfig());
      first.landmarks = map_.keyframe(id)->landmarks;
      tracker_.startFrom(first, id);
      result = tracker_.track(frame, map_, true);
    }
    return result;
  }
  SE3 truthAt(int i) const { return cameraAt({0.01 * i, 0.05 * std::sin(0.1 * i), 0.0}, 0.003 * i); }

  PointScene scene_{1500};
  Tracker tracker_{TrackerConfig()};
  Map map_;
};

TEST_F(TrackerTest, FollowsACurvedPath) {
  EXPECT_EQ(feed(scene_.frame(0, truthAt(0), 0.3, 0.002)).state, TrackingState::kInitialising);
  for (int i = 1; i < 40; ++i) {
    const TrackingResult result = feed(scene_.frame(i, truthAt(i), 0.3, 0.002));
    ASSERT_EQ(result.state, TrackingState::kOk) << i;
    EXPECT_LT(positionError(result.T_camera_world, truthAt(i)), 0.01) << i;
    const double sigma_m = std::sqrt(result.covariance.topLeftCorner<3, 3>().trace());
    EXPECT_LT(sigma_m, 0.01);
    EXPECT_GT(sigma_m, 1e-5);
  }
}

TEST_F(TrackerTest, SaysRecentlyLostThenLostAndFindsBackToTheSamePlace) {
  for (int i = 0; i < 10; ++i) feed(scene_.frame(i, truthAt(i)));
  const TrackingResult dark = feed(TrackedFrame(scene_.frame(10, cameraAt({50, 0, 0}))));
  EXPECT_EQ(dark.state, TrackingState::kRecentlyLost);
  EXPECT_LT(positionError(dark.T_camera_world, truthAt(10)), 0.01) << "constant velocity";
  EXPECT_EQ(feed(scene_.frame(60, cameraAt({50, 0, 0}))).state, TrackingState::kLost);
  const TrackingResult back = feed(scene_.frame(61, truthAt(9)));
  EXPECT_EQ(back.state, TrackingState::kOk);
  EXPECT_LT(positionError(back.T_camera_world, truthAt(9)), 0.005);
}

TEST_F(TrackerTest, AsksForAKeyframeWhenMostOfTheViewIsNew) {
  for (int i = 0; i < 4; ++i) EXPECT_FALSE(feed(scene_.frame(i, truthAt(0))).keyframe_is_due);
  bool due = false;
  for (int i = 4; i < 60 && !due; ++i) due = feed(scene_.frame(i, cameraAt({0.02 * (i - 4), 0, 0}))).keyframe_is_due;
  EXPECT_TRUE(due);
}

TEST(KeyframePolicy, FollowsItsConditions) {
  const KeyframePolicyConfig config;
  KeyframeEvidence e;
  e.tracked = 200;
  e.most_tracked = 220;
  e.close_tracked = 150;
  e.frames_since_keyframe = 100;
  EXPECT_FALSE(keyframeIsDue(e, config)) << "sees nearly all that was seen";
  e.tracked = 130;
  EXPECT_TRUE(keyframeIsDue(e, config));
  e.frames_since_keyframe = 1;
  EXPECT_FALSE(keyframeIsDue(e, config)) << "too soon";
  e.close_tracked = 50;
  e.close_new = 100;
  EXPECT_TRUE(keyframeIsDue(e, config)) << "runs out of close points";
  e.close_new = 0;
  e.tracked = 60;
  e.most_tracked = 60;
  e.all_new = 300;
  EXPECT_FALSE(keyframeIsDue(e, config)) << "too soon";
  e.frames_since_keyframe = 3;
  EXPECT_TRUE(keyframeIsDue(e, config)) << "walks through a doorway: little is tracked, and what is new is far";
  e.tracked = 10;
  EXPECT_FALSE(keyframeIsDue(e, config)) << "too weak to extend the map";
}

TEST(TrajectoryLog, FollowsMovedAndRemovedKeyframes) {
  PointScene scene(300);
  Map map;
  std::vector<KeyframeId> ids;
  for (int i = 0; i < 3; ++i) {
    TrackedFrame frame = scene.frame(i, cameraAt({0.1 * i, 0, 0}));
    frame.T_camera_world = cameraAt({0.1 * i, 0, 0});
    ids.push_back(insertKeyframe(map, frame, SensorConfig(), MapMaintenanceConfig()));
  }
  map.hangTree(ids[2], ids[0]);  // they share no landmarks, so none hangs on another yet
  TrajectoryLog log;
  log.add(Stamp{1}, cameraAt({0.25, 0, 0}), *map.keyframe(ids[2]));
  log.keyframeRemoved(map, *map.keyframe(ids[2]));
  map.removeKeyframe(ids[2]);
  EXPECT_LT((log.poses(map)[0].T_world_camera.translation() - Eigen::Vector3d(0.25, 0, 0)).norm(), 1e-9);
  map.setPose(ids[0], cameraAt({0, 1, 0}));
  EXPECT_LT((log.poses(map)[0].T_world_camera.translation() - Eigen::Vector3d(0.25, 1, 0)).norm(), 1e-9);
}

TEST(TrajectoryLog, LeavesOutPosesOfAMapThatIsNotJoined) {
  PointScene scene(300);
  Map map;
  std::vector<KeyframeId> ids;
  TrajectoryLog log;
  for (int i = 0; i < 2; ++i) {
    TrackedFrame frame = scene.frame(i, cameraAt({0, 0, 0}));
    ids.push_back(insertKeyframe(map, frame, SensorConfig(), MapMaintenanceConfig()));
    log.add(Stamp{i}, cameraAt({0, 0, 0}), *map.keyframe(ids[i]));
  }
  EXPECT_EQ(log.poses(map).size(), 1U);
  map.moveTree(ids[1], cameraAt({-2, 0, 0}));
  map.hangTree(ids[1], ids[0]);
  ASSERT_EQ(log.poses(map).size(), 2U);
  EXPECT_LT((log.poses(map)[1].T_world_camera.translation() - Eigen::Vector3d(2, 0, 0)).norm(), 1e-9);
}

TEST(TrajectoryLog, ForgetsPosesOfTreesThatAreRemoved) {
  PointScene scene(300);
  Map map;
  std::vector<KeyframeId> ids;
  TrajectoryLog log;
  for (int i = 0; i < 3; ++i) {
    TrackedFrame frame = scene.frame(i, cameraAt({0.1 * i, 0, 0}));
    ids.push_back(insertKeyframe(map, frame, SensorConfig(), MapMaintenanceConfig()));
    log.add(Stamp{i}, cameraAt({0.1 * i, 0, 0}), *map.keyframe(ids[i]));
  }
  map.hangTree(ids[2], ids[1]);
  log.keyframeRemoved(map, *map.keyframe(ids[2]));  // its pose is kept by ids[1], until that goes too
  map.removeKeyframe(ids[2]);
  map.removeTree(ids[1]);
  log.treesRemoved(map);
  EXPECT_EQ(log.size(), 1U);
  ASSERT_EQ(log.poses(map).size(), 1U);
  EXPECT_EQ(log.poses(map)[0].stamp, Stamp{0});
}

}  // namespace
}  // namespace semantic_vslam
