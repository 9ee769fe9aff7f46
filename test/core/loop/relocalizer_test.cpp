// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/loop/relocalizer.h"

#include <gtest/gtest.h>

#include "core/support/synthetic_map.h"

namespace semantic_vslam {
namespace {

SE3 lookingAlong(const Eigen::Vector3d& position, double heading_rad) {
  return makeSE3(Eigen::Quaterniond(Eigen::AngleAxisd(heading_rad, Eigen::Vector3d::UnitY())), position).inverse();
}

/// A room of 6 x 3 x 6 m, mapped by a camera that turns round in its middle.
struct RoomMap {
  SyntheticWorld world{21};
  SyntheticMap synthetic;
  PlaceIndex index;

  explicit RoomMap(bool twin = false) {
    world.addRoom({0, 0, 0}, {6, 3, 6}, 4000);
    if (twin) world.addCopy({20, 0, 0});
    for (const double x : twin ? std::vector<double>{0.0, 20.0} : std::vector<double>{0.0}) {
      for (int k = 0; k < 24; ++k) add(lookingAlong({x + 0.02 * (k % 5), 0.0, 0.03 * (k % 3)}, 2.0 * M_PI * k / 24));
    }
  }
  void add(const SE3& pose) {
    const KeyframeId id = addKeyframe(world, synthetic, pose, pose, {});
    index.add(id, *synthetic.map.keyframe(id)->features);
  }
  TrackedFrame frameAt(const SE3& pose) {
    TrackedFrame frame;
    frame.camera = world.camera();
    frame.features = world.observe(pose, {}).features;
    frame.grid = FeatureGrid(*frame.features, 640, 480);
    return frame;
  }
};

TEST(Relocalise, FindsTheCameraAnywhereInTheRoom) {
  RoomMap room;
  int found = 0;
  constexpr int kTrials = 20;
  for (int i = 0; i < kTrials; ++i) {
    const SE3 truth = lookingAlong({room.world.rng().uniform(-0.4, 0.4), 0.1, room.world.rng().uniform(-0.4, 0.4)},
                                   room.world.rng().uniform(0, 2.0 * M_PI));
    const auto result = relocalise(room.synthetic.map, room.index, room.frameAt(truth), {}, {});
    if (!result) continue;
    ++found;
    EXPECT_LT((result->T_camera_world.inverse().translation() - truth.inverse().translation()).norm(), 0.03) << i;
    EXPECT_LT(rotationAngle(result->T_camera_world * truth.inverse()), 0.01) << i;
    EXPECT_GE(result->inliers, 40);
  }
  EXPECT_GE(found, kTrials - 1);
}

TEST(Relocalise, MatchesNameTheRightLandmarks) {
  RoomMap room;
  const SE3 truth = lookingAlong({0.2, 0.0, -0.1}, 1.0);
  const auto view = room.world.observe(truth, {});
  TrackedFrame frame;
  frame.camera = room.world.camera();
  frame.features = view.features;
  frame.grid = FeatureGrid(*frame.features, 640, 480);
  const auto result = relocalise(room.synthetic.map, room.index, frame, {}, {});
  ASSERT_TRUE(result);
  int wrong = 0, matched = 0;
  for (std::size_t i = 0; i < result->landmarks.size(); ++i) {
    if (!result->landmarks[i].valid()) continue;
    ++matched;
    wrong += room.synthetic.point_of.at(result->landmarks[i]) != view.point_of[i] ? 1 : 0;
  }
  EXPECT_EQ(matched, result->inliers);
  EXPECT_LE(wrong, matched / 50);
}

TEST(Relocalise, AnUnknownRoomIsNotRecognised) {
  RoomMap room;
  SyntheticWorld other(77);
  other.addRoom({0, 0, 0}, {6, 3, 6}, 4000);
  for (int i = 0; i < 12; ++i) {
    TrackedFrame frame;
    frame.camera = other.camera();
    frame.features = other.observe(lookingAlong({0, 0, 0}, 0.5 * i), {}).features;
    frame.grid = FeatureGrid(*frame.features, 640, 480);
    EXPECT_FALSE(relocalise(room.synthetic.map, room.index, frame, {}, {}));
  }
}

TEST(Relocalise, TwoRoomsThatLookTheSameAreRefused) {
  RoomMap rooms(true);
  for (int i = 0; i < 6; ++i) {
    EXPECT_FALSE(relocalise(rooms.synthetic.map, rooms.index, rooms.frameAt(lookingAlong({0.1, 0, 0}, i)), {}, {}));
  }
}

TEST(Relocalise, AFrameWithoutFeaturesOrAMapWithoutKeyframesGivesNothing) {
  RoomMap room;
  TrackedFrame empty;
  empty.camera = room.world.camera();
  empty.features = std::make_shared<FrameFeatures>();
  EXPECT_FALSE(relocalise(room.synthetic.map, room.index, empty, {}, {}));
  EXPECT_FALSE(relocalise(Map(), PlaceIndex(), room.frameAt(lookingAlong({0, 0, 0}, 0)), {}, {}));
  // An index that is ahead of the map names keyframes that are gone.
  EXPECT_FALSE(relocalise(Map(), room.index, room.frameAt(lookingAlong({0, 0, 0}, 0)), {}, {}));
}

}  // namespace
}  // namespace semantic_vslam
