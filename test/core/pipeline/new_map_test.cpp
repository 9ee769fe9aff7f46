// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <set>

#include "core/pipeline/sparse_slam.h"
#include "core/support/quarter_vga.h"
#include "eval/synthetic_room.h"
#include "eval/trajectory_error.h"

namespace semantic_vslam {
namespace {

/// An empty office in which the camera stands near the middle and turns by half a radian a second.
Scenario turningCamera() {
  Scenario scenario = makeScenario("static", 1);
  scenario.camera.knots.clear();
  for (int i = 0; i < 9; ++i) scenario.camera.knots.push_back({{0.05 * i, -0.03 * i, 1.25}, 0.5 * (i - 1), -0.15});
  return scenario;
}

/// The camera turns from A towards B, is carried off to B at once, and turns back to A.
class Kidnap {
 public:
  explicit Kidnap(double new_map_after_s = 0.3)
      : room_(turningCamera(), quarterVga()), slam_(config(new_map_after_s)) {}

  /// Turns between two times of the path, either way.
  /// @return state of the last frame
  TrackingState turn(double from_s, double to_s) {
    const int frames = static_cast<int>(std::lround(std::abs(to_s - from_s) * 30.0));
    TrackingState state = TrackingState::kLost;
    for (int i = 0; i <= frames; ++i) {
      const SyntheticFrame rendered = room_.render(from_s + (to_s - from_s) * i / frames);
      RgbdFrame frame = rendered.frame;
      frame.index = index_;
      frame.stamp = Stamp::fromSeconds(1.0 + static_cast<double>(index_++) / 30.0);
      truth_.push_back({frame.stamp, rendered.T_world_camera});
      const SparseStep step = slam_.step(frame, {}, times_, localization_only_);
      state = step.tracking.state;
      new_worlds_ += step.new_world ? 1 : 0;
      relocalised_ += step.tracking.relocalised ? 1 : 0;
    }
    return state;
  }
  /// The stamps to come are those of the start again.
  void setClockBack() {
    index_ = 0;
    slam_.startTimeAnew();
  }
  void setLocalizationOnly(bool on) { localization_only_ = on; }
  int relocalised() const { return relocalised_; }
  int newWorlds() const { return new_worlds_; }
  SparseSlam& slam() { return slam_; }
  double error_m() const { return absoluteTrajectoryError(truth_, slam_.trajectory()).translation_m.max; }
  std::size_t frames() const { return truth_.size(); }

 private:
  static SparseSlamConfig config(double new_map_after_s) {
    SparseSlamConfig config;
    config.tracking.recently_lost_s = 0.2;
    config.tracking.new_map_after_s = new_map_after_s;
    config.tracking.frame.sensor.close_baselines = 60;  // the walls are more than 3 m away
    return config;
  }

  SyntheticRoom room_;
  StageTimes times_;
  SparseSlam slam_;
  std::uint64_t index_ = 0;
  int new_worlds_ = 0, relocalised_ = 0;
  bool localization_only_ = false;
  std::vector<TimedPose> truth_;
};

TEST(NewMap, IsBegunAtAnUnknownPlaceAndJoinedWhenTheOldOneIsSeenAgain) {
  Kidnap kidnap;
  SparseSlam& slam = kidnap.slam();
  ASSERT_EQ(kidnap.turn(0.0, 2.5), TrackingState::kOk);
  const std::size_t old_keyframes = slam.keyframeCount(), old_poses = slam.trajectory().size();

  EXPECT_EQ(kidnap.turn(6.0, 4.5), TrackingState::kLost) << "where the new map lies is not known";
  EXPECT_GT(slam.keyframeCount(), old_keyframes) << "but it grows";
  EXPECT_EQ(slam.keyframePoses().size(), old_keyframes);
  EXPECT_EQ(slam.trajectory().size(), old_poses);

  EXPECT_EQ(kidnap.turn(4.5, 0.0), TrackingState::kOk);
  EXPECT_EQ(slam.keyframePoses().size(), slam.keyframeCount()) << "all of it has its place";
  EXPECT_GT(slam.trajectory().size(), kidnap.frames() - 15) << "but for the frames before the new map was begun";
  EXPECT_LT(kidnap.error_m(), 0.05);
  EXPECT_EQ(kidnap.newWorlds(), 0);
}

/// Keyframes that are in the map but have no place in the world.
std::vector<KeyframeId> awaitingPlace(const SparseSlam& slam) {
  std::set<KeyframeId> awaiting;
  for (std::uint64_t id = 0; id < 1000; ++id) {
    if (slam.holds(KeyframeId(id))) awaiting.insert(KeyframeId(id));
  }
  for (const KeyframePose& placed : slam.keyframePoses()) awaiting.erase(placed.keyframe);
  return {awaiting.begin(), awaiting.end()};
}

TEST(NewMap, IsDroppedWhenLostAgainAtOnce) {
  Kidnap kidnap;
  SparseSlam& slam = kidnap.slam();
  ASSERT_EQ(kidnap.turn(0.0, 2.5), TrackingState::kOk);
  const std::size_t world = slam.keyframeCount();
  kidnap.turn(6.0, 5.5);
  const std::vector<KeyframeId> lost = awaitingPlace(slam);
  ASSERT_FALSE(lost.empty());
  ASSERT_LT(static_cast<int>(lost.size()), MapMaintenanceConfig().min_tree_keyframes);

  kidnap.turn(8.0, 7.5);
  const std::vector<KeyframeId> present = awaitingPlace(slam);
  ASSERT_FALSE(present.empty());
  EXPECT_LT(lost.back(), present.front()) << "the first new map is gone";
  EXPECT_EQ(slam.keyframeCount(), world + present.size()) << "and nothing else";
  kidnap.turn(0.0, 0.3);
  EXPECT_TRUE(awaitingPlace(slam).empty()) << "back in the world, which stays, the second one goes too";
}

TEST(NewMap, IsNotBegunInLocalisationOnlyMode) {
  Kidnap kidnap;
  ASSERT_EQ(kidnap.turn(0.0, 1.0), TrackingState::kOk);
  const std::size_t keyframes = kidnap.slam().keyframeCount();
  kidnap.setLocalizationOnly(true);
  EXPECT_EQ(kidnap.turn(6.0, 5.0), TrackingState::kLost);
  EXPECT_EQ(kidnap.slam().keyframeCount(), keyframes);
}

TEST(NewMap, IsBegunAsSoonAsWaitingTookAsLongAsTheOldOne) {
  Kidnap kidnap(5.0);
  ASSERT_EQ(kidnap.turn(0.0, 1.5), TrackingState::kOk);
  const std::size_t world = kidnap.slam().keyframeCount();
  EXPECT_EQ(kidnap.turn(6.0, 5.1), TrackingState::kLost);
  EXPECT_EQ(kidnap.slam().keyframeCount(), world) << "nothing before";
  EXPECT_EQ(kidnap.turn(5.1, 4.2), TrackingState::kOk);
  EXPECT_EQ(kidnap.newWorlds(), 1);
}

TEST(NewMap, TakesThePlaceOfAWorldThatIsTooSmallToBeFoundAgain) {
  Kidnap kidnap;
  ASSERT_EQ(kidnap.turn(0.0, 0.3), TrackingState::kOk);
  ASSERT_LT(static_cast<int>(kidnap.slam().keyframeCount()), MapMaintenanceConfig().min_tree_keyframes);
  EXPECT_EQ(kidnap.turn(6.0, 4.5), TrackingState::kOk) << "nobody waits for the old place";
  EXPECT_EQ(kidnap.newWorlds(), 1);
  EXPECT_EQ(kidnap.slam().keyframePoses().size(), kidnap.slam().keyframeCount());
  EXPECT_GT(kidnap.slam().trajectory().size(), 25U);
  EXPECT_LT(kidnap.error_m(), 0.05) << "no pose of the old world is left";
}

TEST(NewMap, TheFirstOneIsNotBegunInLocalisationOnlyModeEither) {
  Kidnap kidnap;
  kidnap.setLocalizationOnly(true);
  EXPECT_EQ(kidnap.turn(0.0, 0.5), TrackingState::kInitialising);
  EXPECT_EQ(kidnap.slam().keyframeCount(), 0U);
  kidnap.setLocalizationOnly(false);
  EXPECT_EQ(kidnap.turn(0.5, 1.0), TrackingState::kOk);
}

TEST(NewMap, IsNotNeededWhenTheClockIsSetBack) {
  Kidnap kidnap;
  ASSERT_EQ(kidnap.turn(0.0, 1.5), TrackingState::kOk);
  const std::size_t keyframes = kidnap.slam().keyframeCount();
  kidnap.setClockBack();
  EXPECT_EQ(kidnap.turn(1.0, 0.5), TrackingState::kOk) << "found in the map, which stays";
  EXPECT_GE(kidnap.slam().keyframePoses().size(), keyframes);
  EXPECT_LE(kidnap.slam().trajectory().size(), 16U);
  EXPECT_EQ(kidnap.relocalised(), 1) << "only the frame that was recognised is said to be";
}

}  // namespace
}  // namespace semantic_vslam
