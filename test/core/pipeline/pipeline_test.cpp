// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "semantic_vslam/core/pipeline/pipeline.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "core/dense/dense_mapper.h"
#include "core/pipeline/sparse_slam.h"
#include "core/support/motion_alone.h"
#include "core/support/quarter_vga.h"
#include "eval/synthetic_room.h"
#include "eval/trajectory_error.h"
#include "semantic_vslam/core/common/config_fields.h"
#include "semantic_vslam/core/common/error.h"
#include "semantic_vslam/core/common/log.h"

namespace semantic_vslam {
namespace {

/// The first two seconds of the walking scenario, in which somebody passes, rendered once for all tests.
const std::vector<SyntheticFrame>& walkingFrames() {
  static const std::vector<SyntheticFrame> frames = [] {
    constexpr int kFrames = 60;
    const SyntheticRoom room(makeScenario("walking", 1), quarterVga());
    std::vector<SyntheticFrame> rendered;
    for (int i = 0; i < kFrames; ++i) {
      rendered.push_back(room.render(room.frameTime(i)));
      rendered.back().frame.index = static_cast<std::uint64_t>(i);
    }
    return rendered;
  }();
  return frames;
}

struct Outcome {
  int posed = 0;
  std::vector<TimedPose> trajectory;
  std::vector<LabelledPoint> cloud;
  std::size_t keyframes = 0;
};

Outcome run(const SystemConfig& config) {
  Pipeline system(config);
  Outcome out;
  for (const SyntheticFrame& synthetic : walkingFrames()) out.posed += system.step(synthetic.frame).posed() ? 1 : 0;
  system.finish();
  out.trajectory = system.slam().trajectory();
  out.cloud = system.dense().cloud();
  out.keyframes = system.slam().keyframeCount();
  return out;
}

double trajectoryError(const Outcome& result) {
  std::vector<TimedPose> truth;
  for (const SyntheticFrame& synthetic : walkingFrames()) {
    truth.push_back({synthetic.frame.stamp, synthetic.T_world_camera});
  }
  return absoluteTrajectoryError(truth, result.trajectory).translation_m.rmse;
}

std::string readFile(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

TEST(Pipeline, FollowsTheCameraThroughPeople) {
  const Outcome result = run(motionAlone());
  EXPECT_GE(result.posed, 58) << "all but the frame or two of the initialisation";
  EXPECT_EQ(result.trajectory.size(), static_cast<std::size_t>(result.posed) + 1) << "k1 gets its pose afterwards";
  EXPECT_LT(trajectoryError(result), 0.025);
  EXPECT_GT(result.keyframes, 1U);
  EXPECT_GT(result.cloud.size(), 10000U);
}

TEST(Pipeline, TheSameInputGivesTheSameBytes) {
  const Outcome a = run(motionAlone()), b = run(motionAlone());
  ASSERT_EQ(a.trajectory.size(), b.trajectory.size());
  for (std::size_t i = 0; i < a.trajectory.size(); ++i) {
    EXPECT_EQ(a.trajectory[i].T_world_camera.matrix(), b.trajectory[i].T_world_camera.matrix()) << i;
  }
  ASSERT_EQ(a.cloud.size(), b.cloud.size());
  for (std::size_t i = 0; i < a.cloud.size(); ++i) {
    ASSERT_EQ(a.cloud[i].xyz_m, b.cloud[i].xyz_m);
    ASSERT_EQ(a.cloud[i].bgr, b.cloud[i].bgr);
  }
}

TEST(Pipeline, APlaceThatIsSeenOverAndOverTakesNoMoreMemory) {
  Pipeline system(motionAlone());
  const auto& frames = walkingFrames();
  constexpr int kPasses = 10, kEvery = 4;  // of 30 Hz, as on a machine that is too slow
  std::vector<std::size_t> keyframes, landmarks;
  std::uint64_t index = 0;
  for (int pass = 0; pass < kPasses; ++pass) {
    std::vector<TimedPose> truth, estimate;
    for (std::size_t i = 0; i < frames.size(); i += kEvery) {
      const SyntheticFrame& shown = frames[pass % 2 == 0 ? i : frames.size() - 1 - i];
      RgbdFrame frame = shown.frame;
      frame.index = index;
      frame.stamp = Stamp::fromSeconds(100.0 + static_cast<double>(index) / 30.0);
      index += kEvery;
      const StepResult result = system.step(frame);
      if (!result.posed()) continue;
      truth.push_back({frame.stamp, shown.T_world_camera});
      estimate.push_back({frame.stamp, result.T_world_camera()});
    }
    ASSERT_GE(estimate.size(), 10U) << pass;
    EXPECT_LT(absoluteTrajectoryError(truth, estimate).translation_m.rmse, 0.03) << pass;
    keyframes.push_back(system.slam().keyframeCount());
    landmarks.push_back(system.slam().landmarkCount());
    EXPECT_LE(system.dense().keyframes(), 3 * keyframes.back() + 2) << pass;
  }
  EXPECT_EQ(system.slam().loopCount(), 0U) << "the place was never left";
  EXPECT_LE(keyframes.back(), keyframes[3] + 2);
  EXPECT_LE(static_cast<double>(landmarks.back()), 1.1 * static_cast<double>(landmarks[3]));
}

/// A network that knows the truth: what it says of an image is looked up by the image itself.
class TrueLabels final : public Segmenter {
 public:
  const LabelSet& labels() const override { return labels_; }
  Segmentation segment(const cv::Mat3b& bgr) override {
    for (const SyntheticFrame& synthetic : walkingFrames()) {
      if (synthetic.frame.bgr.data == bgr.data) return {synthetic.labels};
    }
    return {cv::Mat1b::zeros(bgr.size())};
  }

 private:
  LabelSet labels_ = syntheticLabels();
};

/// Share of the cloud's points that lie on a person: nearer than what the true view without people shows.
double shareOnPeople(const std::vector<LabelledPoint>& cloud, const SE3& T_truth_map) {
  const auto& frames = walkingFrames();
  std::size_t on_people = 0;
  for (const LabelledPoint& point : cloud) {
    const Eigen::Vector3d p_world = T_truth_map * Eigen::Vector3d(point.xyz_m[0], point.xyz_m[1], point.xyz_m[2]);
    for (std::size_t i = 0; i < frames.size(); i += 5) {
      const Eigen::Vector3d p = frames[i].T_world_camera.inverse() * p_world;
      if (p.z() < 0.1) continue;
      const Eigen::Vector2d px = frames[i].frame.camera->projectRaw(p);
      const cv::Point pixel(cvRound(px.x()), cvRound(px.y()));
      if (!cv::Rect(0, 0, 320, 240).contains(pixel) || frames[i].person_mask(pixel) == 0) continue;
      if (std::abs(frames[i].true_depth_m(pixel) - p.z()) < 0.03) {
        ++on_people;
        break;
      }
    }
  }
  return static_cast<double>(on_people) / static_cast<double>(cloud.size());
}

TEST(Pipeline, NoPersonEntersTheMap) {
  double people_px = 0.0;
  for (const SyntheticFrame& synthetic : walkingFrames()) people_px += cv::countNonZero(synthetic.person_mask);
  ASSERT_GT(people_px / static_cast<double>(walkingFrames().size()), 0.05 * 320 * 240)
      << "there are people to leave out";
  Pipeline system(SystemConfig(), std::make_unique<TrueLabels>());
  for (const SyntheticFrame& synthetic : walkingFrames()) system.step(synthetic.frame);
  system.finish();
  const auto cloud = system.dense().cloud();
  ASSERT_GT(cloud.size(), 10000U);
  const LabelSet labels = syntheticLabels();
  std::size_t labelled = 0;
  for (const LabelledPoint& point : cloud) {
    EXPECT_NE(labels.mobility(point.label), Mobility::kPerson);
    labelled += point.label != 0 ? 1 : 0;
  }
  EXPECT_GT(labelled, cloud.size() / 100) << "furniture carries its labels";
  const SE3 T_map_first = system.slam().trajectory().front().T_world_camera;
  EXPECT_LT(shareOnPeople(cloud, walkingFrames().front().T_world_camera * T_map_first.inverse()), 0.01);
}

/// Says that there is nobody, and counts how often it is asked.
class CountingSegmenter final : public Segmenter {
 public:
  explicit CountingSegmenter(int& count) : count_(count) {}
  const LabelSet& labels() const override { return labels_; }
  Segmentation segment(const cv::Mat3b& bgr) override {
    ++count_;
    return {cv::Mat1b::zeros(bgr.size())};
  }

 private:
  int& count_;
  LabelSet labels_ = syntheticLabels();
};

TEST(Pipeline, ACameraThatStandsStillIsStillTold) {
  for (const double longest_gap_s : {0.5, 3600.0}) {
    SystemConfig config;
    config.segmentation.longest_gap_s = longest_gap_s;
    int asked = 0;
    Pipeline system(config, std::make_unique<CountingSegmenter>(asked));
    constexpr int kFrames = 60;  // 2 s
    for (int i = 0; i < kFrames; ++i) {
      RgbdFrame frame = walkingFrames()[0].frame;
      frame.index = static_cast<std::uint64_t>(i);
      frame.stamp = Stamp{frame.stamp.ns + i * 33333333LL};
      system.step(frame);
    }
    EXPECT_EQ(system.slam().keyframeCount(), 1U);
    EXPECT_EQ(asked, longest_gap_s < 1.0 ? 4 : 1) << "first, and after 0.53, 1.07 and 1.6 s; or the keyframe alone";
  }
}

TEST(Pipeline, AFrameThatIsNotNewerIsPassedOver) {
  Pipeline system{motionAlone()};
  const auto& frames = walkingFrames();
  system.step(frames[0].frame);
  EXPECT_TRUE(system.step(frames[1].frame).posed());
  EXPECT_FALSE(system.step(frames[1].frame).posed());
  EXPECT_FALSE(system.step(frames[0].frame).posed());
  EXPECT_TRUE(system.step(frames[2].frame).posed());
}

/// What was logged while it is there.
class HeardLog {
 public:
  HeardLog() {
    setLogSink([this](LogLevel, const std::string& line) { lines_.push_back(line); });
  }
  ~HeardLog() { setLogSink({}); }
  std::size_t count(const std::string& part) const {
    return static_cast<std::size_t>(std::count_if(
        lines_.begin(), lines_.end(), [&](const std::string& line) { return line.find(part) != std::string::npos; }));
  }

 private:
  std::vector<std::string> lines_;
};

class ClockSetBack : public testing::TestWithParam<double> {};

TEST_P(ClockSetBack, KeepsTheMapAndGoesOnAfterTwoFrames) {
  Pipeline system{motionAlone()};
  const auto& frames = walkingFrames();
  for (int i = 0; i < 10; ++i) system.step(frames[i].frame);
  const KeyframeId first = system.slam().keyframePoses().front().keyframe;
  const HeardLog log;
  for (int i = 10; i < 16; ++i) {
    RgbdFrame earlier = frames[i].frame;
    earlier.stamp.ns -= Stamp::fromSeconds(GetParam()).ns;
    EXPECT_EQ(system.step(earlier).posed(), i >= 12) << i;
  }
  EXPECT_EQ(log.count("the map stays"), 1U);
  EXPECT_EQ(system.slam().keyframePoses().front().keyframe, first);
  EXPECT_EQ(system.slam().map().roots().size(), system.slam().keyframePoses().size()) << "and no other map is begun";
  EXPECT_LE(system.trajectory().size(), 4U) << "the trajectory begins anew";
}

INSTANTIATE_TEST_SUITE_P(BySeconds, ClockSetBack, testing::Values(0.5, 2.0, 5.0, 10.0));

TEST(Pipeline, AShortRecordingInALoopIsFollowedInOneMap) {
  Pipeline system{motionAlone()};
  const auto& frames = walkingFrames();
  constexpr int kLaps = 4, kLength = 15;
  int posed = 0;
  const HeardLog log;
  for (int i = 0; i < kLaps * kLength; ++i) {
    RgbdFrame frame = frames[i % kLength].frame;
    frame.index = static_cast<std::uint64_t>(i);
    posed += system.step(frame).posed() ? 1 : 0;
  }
  EXPECT_GE(posed, kLaps * (kLength - 2) - 1);
  EXPECT_EQ(log.count("the map stays"), static_cast<std::size_t>(kLaps - 1));
  EXPECT_EQ(system.slam().map().roots().size(), system.slam().keyframePoses().size()) << "one map";
}

TEST(Pipeline, OneStampInTheFutureCostsItsFrameAlone) {
  Pipeline system{motionAlone()};
  const auto& frames = walkingFrames();
  const HeardLog log;
  for (int i = 0; i < 12; ++i) {
    RgbdFrame frame = frames[i].frame;
    if (i == 6) frame.stamp.ns += 3'600'000'000'000;
    EXPECT_EQ(system.step(frame).posed(), i > 0 && i != 6) << i;
  }
  EXPECT_EQ(log.count("stamp"), 1U);
  EXPECT_EQ(system.trajectory().size(), 11U);
}

TEST(Pipeline, FramesThatAreNumberedInsteadOfStampedAreNotMappedAndThatIsSaid) {
  Pipeline system{motionAlone()};
  const auto& frames = walkingFrames();
  int posed = 0;
  const HeardLog log;
  for (int i = 0; i < 20; ++i) {
    RgbdFrame frame = frames[i].frame;
    frame.stamp = Stamp::fromSeconds(1.0 + i);
    const StepResult result = system.step(frame);
    posed += result.posed() ? 1 : 0;
    EXPECT_FALSE(result.motion.told);
    EXPECT_TRUE(result.mapped.empty()) << "people would be in it";
  }
  system.finish();
  EXPECT_GE(posed, 19) << "the pose is told all the same";
  EXPECT_TRUE(system.cloud().empty());
  EXPECT_EQ(log.count("motion cannot be told"), 1U);
}

TEST(Pipeline, DarknessLosesNothingThatIsMapped) {
  Pipeline system{motionAlone()};
  const auto& frames = walkingFrames();
  for (int i = 0; i < 20; ++i) system.step(frames[i].frame);
  const std::size_t keyframes = system.slam().keyframeCount(), landmarks = system.slam().landmarkCount();
  for (int i = 20; i < 30; ++i) {
    RgbdFrame dark = frames[i].frame;
    dark.bgr = cv::Mat3b(dark.bgr.size(), cv::Vec3b(0, 0, 0));
    dark.gray = cv::Mat1b(dark.gray.size(), std::uint8_t{0});
    dark.depth_m = cv::Mat1f(dark.depth_m.size(), 0.0F);
    const StepResult result = system.step(dark);
    EXPECT_FALSE(result.posed());
    EXPECT_EQ(result.tracking.state, TrackingState::kRecentlyLost);
  }
  EXPECT_EQ(system.slam().keyframeCount(), keyframes);
  EXPECT_EQ(system.slam().landmarkCount(), landmarks);
  EXPECT_TRUE(system.step(frames[30].frame).posed() || system.step(frames[31].frame).posed());
}

/// The frame as if it had been taken later.
RgbdFrame at(const RgbdFrame& frame, std::uint64_t index) {
  RgbdFrame later = frame;
  later.index = index;
  later.stamp = Stamp{walkingFrames().front().frame.stamp.ns + static_cast<std::int64_t>(index) * 33'333'333};
  return later;
}

TEST(SparseSlam, FindsBackAfterTheCameraWasCovered) {
  StageTimes times;
  SparseSlam slam{SparseSlamConfig()};
  const auto& frames = walkingFrames();
  std::vector<SE3> T_camera_world;
  std::uint64_t index = 0;
  for (int i = 0; i < 30; ++i) {
    T_camera_world.push_back(
        slam.step(at(frames[i].frame, index++), frames[i].person_mask, times).tracking.T_camera_world);
  }
  RgbdFrame dark = frames[0].frame;
  dark.gray = cv::Mat1b(dark.gray.size(), std::uint8_t{0});
  dark.depth_m = cv::Mat1f(dark.depth_m.size(), 0.0F);
  TrackingState state = TrackingState::kOk;
  for (int i = 0; i < 60; ++i) state = slam.step(at(dark, index++), {}, times).tracking.state;
  EXPECT_EQ(state, TrackingState::kLost);

  constexpr int kAgain = 8;  // seen before, but not where the camera was when it got dark
  int needed = 0;
  SparseStep step;
  do {
    step = slam.step(at(frames[kAgain + needed].frame, index++), frames[kAgain + needed].person_mask, times);
  } while (step.tracking.state != TrackingState::kOk && ++needed < 10);
  ASSERT_EQ(step.tracking.state, TrackingState::kOk);
  const SE3 difference = step.tracking.T_camera_world * T_camera_world[kAgain + needed].inverse();
  EXPECT_LT(difference.translation().norm(), 0.02);
}

TEST(SparseSlam, AfterEveryCutAndJumpItFindsTheRightPlace) {
  StageTimes times;
  SparseSlam slam{SparseSlamConfig()};
  const auto& frames = walkingFrames();
  std::uint64_t index = 0;
  const auto show = [&](int i) {
    return slam.step(at(frames[i].frame, index++), frames[i].person_mask, times).tracking;
  };
  std::vector<SE3> T_camera_world;
  for (int i = 0; i < 60; ++i) T_camera_world.push_back(show(i).T_camera_world);
  const std::size_t keyframes = slam.keyframeCount();

  RgbdFrame dark = frames[0].frame;
  dark.gray = cv::Mat1b(dark.gray.size(), std::uint8_t{0});
  dark.depth_m = cv::Mat1f(dark.depth_m.size(), 0.0F);
  for (const int place : {5, 45, 20, 49, 10, 35}) {
    const bool covered = place % 2 == 1;
    if (covered) {
      for (int i = 0; i < 45; ++i) slam.step(at(dark, index++), {}, times);
    } else {
      index += 45;
    }
    int found = 0;
    for (int i = 0; i < 10; ++i) {
      const TrackingResult result = show(place + i);
      if (result.state != TrackingState::kOk) continue;
      ++found;
      const SE3 difference = result.T_camera_world * T_camera_world[place + i].inverse();
      EXPECT_LT(difference.translation().norm(), 0.05) << "place " << place << " frame " << i;
    }
    EXPECT_GT(found, 0) << "place " << place;
  }
  EXPECT_GE(slam.keyframeCount() + 3, keyframes) << "nothing is forgotten but what is redundant";
}

TEST(SparseSlam, LocalisesInASavedMapAndLeavesItAlone) {
  StageTimes times;
  const auto& frames = walkingFrames();
  const std::string first = ::testing::TempDir() + "slam_map_first.bin",
                    second = ::testing::TempDir() + "slam_map_2.bin";
  SE3 expected;
  {
    SparseSlam slam{SparseSlamConfig()};
    for (int i = 0; i < 40; ++i) slam.step(at(frames[i].frame, i), frames[i].person_mask, times);
    expected = slam.trajectory().at(20).T_world_camera.inverse();  // as the map that is saved has it
    slam.saveMap(first);
  }
  SparseSlam slam{SparseSlamConfig()};
  slam.loadMap(first);
  int posed = 0;
  for (int i = 20; i < 60; ++i) {
    const SparseStep step = slam.step(at(frames[i].frame, i), frames[i].person_mask, times, true);
    EXPECT_FALSE(step.keyframe);
    if (step.tracking.state != TrackingState::kOk) continue;
    if (posed == 0) {
      EXPECT_LE(i, 30);
    }
    if (i == 20) {
      EXPECT_LT((step.tracking.T_camera_world * expected.inverse()).translation().norm(), 0.02);
    }
    ++posed;
  }
  EXPECT_GE(posed, 30);
  slam.saveMap(second);
  EXPECT_TRUE(readFile(first) == readFile(second)) << "the map's bytes must not change";
  std::remove(first.c_str());
  std::remove(second.c_str());
}

TEST(SparseSlam, ABadMapFileChangesNothing) {
  StageTimes times;
  SparseSlam slam{SparseSlamConfig()};
  for (int i = 0; i < 10; ++i) slam.step(at(walkingFrames()[i].frame, i), {}, times);
  const std::size_t landmarks = slam.landmarkCount(), poses = slam.trajectory().size();
  EXPECT_THROW(slam.loadMap("/no/such/map"), FileError);
  EXPECT_EQ(slam.landmarkCount(), landmarks);
  EXPECT_EQ(slam.trajectory().size(), poses);
}

TEST(SystemConfig, KeysAreUniqueAndTheDefaultsValid) {
  EXPECT_NO_THROW(validateConfig(SystemConfig()));
  std::set<std::string> keys;
  for (const auto& entry : listConfig(SystemConfig())) {
    EXPECT_TRUE(keys.insert(entry.key).second) << entry.key;
    EXPECT_FALSE(entry.documentation.empty()) << entry.key;
  }
  EXPECT_GT(keys.count("tracking.orb.features"), 0U);
  EXPECT_GT(keys.count("motion.model"), 0U);
}

TEST(Pipeline, RefusesAConfigOutOfRangeByName) {
  SystemConfig config;
  config.slam.tracking.frame.search_radius_px = -1.0;
  try {
    Pipeline system(config);
    FAIL() << "must not be constructed";
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("search_radius_px"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace semantic_vslam
