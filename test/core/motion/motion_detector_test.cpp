// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/motion/motion_detector.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "core/common/rng.h"
#include "core/support/quarter_vga.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

RgbdFrame texturedFrame(int index, float depth_m, int shift_px) {
  Rng rng(4);
  cv::Mat1b large(300, 400);
  for (uchar& value : large) value = static_cast<uchar>(rng.below(256));
  cv::GaussianBlur(large, large, {0, 0}, 3.0);
  cv::normalize(large, large, 0, 255, cv::NORM_MINMAX);
  static const auto camera = std::make_shared<const CameraModel>(quarterVga());
  const cv::Mat1b gray = large(cv::Rect(40 - shift_px, 30, 320, 240)).clone();
  return makeRgbdFrame(static_cast<std::uint64_t>(index), Stamp::fromSeconds(1.0 + 0.033 * index), gray,
                       cv::Mat1f(240, 320, depth_m), 0.001, camera);
}

bool hasNan(const cv::Mat& image) { return !image.empty() && !cv::checkRange(image); }

TEST(MotionDetectorTest, FirstFrameIsAllStaticAndHasNoFlow) {
  MotionDetector detector{MotionConfig()};
  const MotionResult result = detector.detect(texturedFrame(0, 2.0F, 0));
  EXPECT_EQ(result.dynamic.size(), cv::Size(320, 240));
  EXPECT_EQ(cv::countNonZero(result.dynamic), 0);
  EXPECT_EQ(cv::countNonZero(result.moving), 0);
  EXPECT_TRUE(result.flow_px.empty());
  EXPECT_EQ(result.model, MotionModel::kNone);
  EXPECT_FALSE(result.told);
}

TEST(MotionDetectorTest, BetweenFramesThatAreFarApartNoMotionIsTold) {
  MotionDetector detector{MotionConfig()};
  double now_s = 1.0;
  const auto told = [&](double gap_s, int index) {
    RgbdFrame frame = texturedFrame(index, 2.0F, index);
    frame.stamp = Stamp::fromSeconds(now_s += gap_s);
    return detector.detect(frame).told;
  };
  EXPECT_FALSE(told(0.0, 0)) << "there is no frame before";
  EXPECT_TRUE(told(0.03, 1));
  EXPECT_TRUE(told(0.45, 2));
  EXPECT_FALSE(told(1.0, 3)) << "numbered instead of stamped, as good as a second apart";
  EXPECT_FALSE(told(0.6, 4));
  EXPECT_TRUE(told(0.03, 5));
}

TEST(MotionDetectorTest, WithoutAModelNothingIsToBeTold) {
  MotionConfig config;
  config.model = "none";
  MotionDetector detector{config};
  EXPECT_TRUE(detector.detect(texturedFrame(0, 2.0F, 0)).told);
  EXPECT_TRUE(detector.detect(texturedFrame(1, 2.0F, 0)).told);
}

TEST(MotionDetectorTest, FlowIsInPixelsOfTheFullImage) {
  MotionDetector detector{MotionConfig()};
  detector.detect(texturedFrame(0, 2.0F, 0));
  const MotionResult result = detector.detect(texturedFrame(1, 2.0F, 4));
  const cv::Scalar mean = cv::mean(result.flow_px);
  EXPECT_NEAR(mean[0], 4.0, 0.3);
  EXPECT_NEAR(mean[1], 0.0, 0.3);
}

TEST(MotionDetectorTest, ImageWithoutDepthFallsBackToTheHomography) {
  MotionDetector detector{MotionConfig()};
  detector.detect(texturedFrame(0, 0.0F, 0));
  const MotionResult result = detector.detect(texturedFrame(1, 0.0F, 3));
  EXPECT_EQ(result.model, MotionModel::kHomography);
  EXPECT_LT(result.dynamic_share, 0.02);
  EXPECT_FALSE(hasNan(result.flow_px));
  EXPECT_FALSE(hasNan(result.residual_px));
}

TEST(MotionDetectorTest, BlackImageTellsNothingAndBreaksNothing) {
  MotionDetector detector{MotionConfig()};
  for (int i = 0; i < 4; ++i) {
    RgbdFrame frame = texturedFrame(i, 0.0F, 0);
    frame.gray = cv::Mat1b::zeros(240, 320);
    const MotionResult result = detector.detect(frame);
    EXPECT_EQ(result.model, MotionModel::kNone);
    EXPECT_FALSE(result.told);
    EXPECT_EQ(cv::countNonZero(result.dynamic >= 128), 0);
    EXPECT_FALSE(hasNan(result.flow_px));
  }
}

TEST(MotionDetectorTest, LabelsOfTheFirstFrameCountInTheSecond) {
  LabelSet labels;
  labels.classes.push_back({"person", Mobility::kPerson, {}});
  for (const char* model : {"none", "homography", "rigid_flow"}) {
    MotionConfig config;
    config.model = model;
    MotionDetector detector(config);
    const RgbdFrame first = texturedFrame(0, 2.0F, 0);
    detector.detect(first);
    cv::Mat1b person = cv::Mat1b::zeros(240, 320);
    person(cv::Rect(100, 60, 60, 120)) = 1;
    ASSERT_TRUE(detector.addLabels(first.stamp, person, labels));
    const MotionResult result = detector.detect(texturedFrame(1, 2.0F, 4));
    EXPECT_GE(result.dynamic(120, 134), 128) << model;
    EXPECT_LT(result.dynamic(120, 40), 128) << model;
    EXPECT_LT(result.moving(60, 67), 128) << model;  // it did not move by itself
  }
}

TEST(MotionDetectorTest, LabelsCountForAFrameInWhichNoMotionCouldBeTold) {
  LabelSet labels;
  labels.classes.push_back({"person", Mobility::kPerson, {}});
  MotionConfig config;
  config.model = "none";
  MotionDetector detector(config);
  for (int i = 0; i < 3; ++i) detector.detect(texturedFrame(i, 2.0F, 0));
  cv::Mat1b person = cv::Mat1b::zeros(240, 320);
  person(cv::Rect(100, 60, 60, 120)) = 1;
  ASSERT_TRUE(detector.addLabels(texturedFrame(1, 2.0F, 0).stamp, person, labels));
  EXPECT_GE(detector.detect(texturedFrame(3, 2.0F, 0)).dynamic(120, 130), 128);
}

TEST(MotionDetectorTest, OtherThresholdsLeaveWhatIsKnownOfTheScene) {
  LabelSet labels;
  labels.classes.push_back({"person", Mobility::kPerson, {}});
  MotionConfig config;
  MotionDetector detector(config);
  detector.detect(texturedFrame(0, 2.0F, 0));
  cv::Mat1b person = cv::Mat1b::zeros(240, 320);
  person(cv::Rect(100, 60, 60, 120)) = 1;
  ASSERT_TRUE(detector.addLabels(texturedFrame(0, 2.0F, 0).stamp, person, labels));
  config.memory.time_constant_s = 1.0;
  detector.setConfig(config);
  const MotionResult result = detector.detect(texturedFrame(1, 2.0F, 4));
  EXPECT_EQ(result.model, MotionModel::kRigidFlow);  // the frame before is still there
  EXPECT_GE(result.dynamic(120, 134), 128);
  config.memory.time_constant_s = -1.0;
  EXPECT_THROW(detector.setConfig(config), ConfigError);
}

TEST(MotionDetectorTest, OldMaskGivesWayToASurfaceThatStandsStill) {
  LabelSet labels;
  labels.classes.push_back({"person", Mobility::kPerson, {}});
  MotionDetector detector{MotionConfig()};
  detector.detect(texturedFrame(0, 2.0F, 0));
  cv::Mat1b person = cv::Mat1b::zeros(240, 320);
  person(cv::Rect(100, 60, 60, 120)) = 1;
  ASSERT_TRUE(detector.addLabels(texturedFrame(0, 2.0F, 0).stamp, person, labels));
  std::vector<int> dynamic;
  for (int i = 1; i <= 60; ++i) dynamic.push_back(detector.detect(texturedFrame(i, 2.0F, 0)).dynamic(120, 130));
  EXPECT_GE(dynamic[9], 128);   // a third of a second old: who stands still stays out
  EXPECT_LT(dynamic[59], 128);  // two seconds, and nothing but rest since
}

TEST(MotionDetectorTest, ADeskCalledAPersonOnceStaysADesk) {
  MotionDetector detector{MotionConfig()};
  LabelSet labels;
  labels.classes.push_back({"person", Mobility::kPerson, {}});
  const cv::Mat1b nobody = cv::Mat1b::zeros(240, 320), everywhere(240, 320, static_cast<uchar>(1));
  const auto dynamicShareWith = [&](const cv::Mat1b& seen, int from) {
    MotionResult result;
    for (int i = from; i < from + 20; ++i) {
      result = detector.detect(texturedFrame(i, 2.0F, 0));
      if (i > from) continue;
      EXPECT_TRUE(detector.addLabels(Stamp::fromSeconds(1.0 + 0.033 * i), seen, labels));
    }
    return result.dynamic_share;
  };
  EXPECT_EQ(dynamicShareWith(nobody, 0), 0.0);
  EXPECT_EQ(dynamicShareWith(nobody, 20), 0.0);
  EXPECT_EQ(dynamicShareWith(everywhere, 40), 0.0);
  for (const int from : {60, 80, 100, 120}) dynamicShareWith(everywhere, from);
  EXPECT_GT(dynamicShareWith(everywhere, 140), 0.9) << "a network that insists is believed";
}

TEST(MotionDetectorTest, WhoStandsStillStaysOutAsLongAsLabelsComeTwiceASecond) {
  MotionDetector detector{MotionConfig()};
  LabelSet labels;
  labels.classes.push_back({"person", Mobility::kPerson, {}});
  const cv::Mat1b everywhere(240, 320, static_cast<uchar>(1));
  constexpr int kGapFrames = 15, kLateFrames = 8;  // 0.5 s, and the network's own 0.26 s
  for (int i = 0; i < 120; ++i) {
    const MotionResult result = detector.detect(texturedFrame(i, 2.0F, 0));
    EXPECT_EQ(result.dynamic_share > 0.9, i > kLateFrames) << i;
    if (i % kGapFrames != kLateFrames) continue;
    EXPECT_TRUE(detector.addLabels(Stamp::fromSeconds(1.0 + 0.033 * (i - kLateFrames)), everywhere, labels));
  }
}

/// A wall that stands still, twelve frames a second, every sixth one a keyframe at its place in the map.
class MotionDetectorInMap : public testing::Test {
 protected:
  RgbdFrame frameAt(int index, bool visited) const {
    RgbdFrame frame = texturedFrame(0, 2.0F, 0);
    frame.index = static_cast<std::uint64_t>(index);
    frame.stamp = Stamp::fromSeconds(1.0 + index / 12.0);
    if (!visited) return frame;
    texturedFrame(0, 2.0F, 37).gray(visitor).copyTo(frame.gray(visitor));
    frame.depth_m(visitor).setTo(1.0F);
    return frame;
  }
  MotionResult see(const RgbdFrame& frame) {
    const MotionResult result = detector.detect(frame);
    if (frame.index % 6 == 0) keyframes.push_back({frame.stamp, SE3::Identity()});
    if (frame.index % 6 == 0) detector.takeKeyframePoses(keyframes);
    detector.takeFramePose({frame.stamp, SE3::Identity()});
    return result;
  }

  const cv::Rect visitor{110, 50, 80, 150};
  const cv::Point on_visitor{150, 120}, on_wall{40, 120};
  MotionDetector detector{MotionConfig()};
  std::vector<TimedPose> keyframes;
};

TEST_F(MotionDetectorInMap, WhoComesAndStopsForManySecondsStaysOut) {
  int index = 0;
  for (; index < 36; ++index) EXPECT_LT(see(frameAt(index, false)).dynamic(on_visitor), 128) << index;
  for (; index < 36 + 12 * 12; ++index) {
    const MotionResult result = see(frameAt(index, true));
    if (index >= 40) {
      EXPECT_GE(result.dynamic(on_visitor), 128) << index;
    }
    if (index >= 40) {
      EXPECT_LT(result.dynamic(on_wall), 128) << index;
    }
  }
  for (int gone = 0; gone < 12; ++gone, ++index) see(frameAt(index, false));
  EXPECT_LT(see(frameAt(index, false)).dynamic(on_visitor), 128) << "the wall behind is known";
}

TEST_F(MotionDetectorInMap, ALabelOnALongKnownSurfaceGivesWay) {
  LabelSet labels;
  labels.classes.push_back({"person", Mobility::kPerson, {}});
  cv::Mat1b left_half = cv::Mat1b::zeros(240, 320);
  left_half(cv::Rect(0, 0, 160, 240)) = 1;
  for (int index = 0; index < 72; ++index) {
    const RgbdFrame frame = frameAt(index, false);
    const MotionResult result = see(frame);
    if (index % 6 == 0) detector.addLabels(frame.stamp, left_half, labels);
    if (index == 12) {
      EXPECT_GE(result.dynamic(on_wall), 128) << "a second of rest does not contradict a person";
    }
    if (index > 66) {
      EXPECT_LT(result.dynamic(on_wall), 128) << index;
    }
  }
}

TEST_F(MotionDetectorInMap, ALabelOnWhoCameHolds) {
  LabelSet labels;
  labels.classes.push_back({"person", Mobility::kPerson, {}});
  cv::Mat1b person = cv::Mat1b::zeros(240, 320);
  person(visitor) = 1;
  for (int index = 0; index < 120; ++index) {
    const RgbdFrame frame = frameAt(index, index >= 36);
    const MotionResult result = see(frame);
    if (index >= 36 && index % 6 == 0) detector.addLabels(frame.stamp, person, labels);
    if (index >= 44) {
      EXPECT_GE(result.dynamic(on_visitor), 128) << index;
    }
  }
}

TEST(MotionDetectorTest, StampThatGoesBackStartsAnew) {
  MotionDetector detector{MotionConfig()};
  detector.detect(texturedFrame(5, 2.0F, 0));
  detector.detect(texturedFrame(6, 2.0F, 1));
  const MotionResult result = detector.detect(texturedFrame(2, 2.0F, 2));
  EXPECT_EQ(result.model, MotionModel::kNone);
  EXPECT_TRUE(result.flow_px.empty());
}

TEST(MotionDetectorTest, SameFramesGiveTheSameBytes) {
  const auto run = [] {
    MotionDetector detector{MotionConfig()};
    MotionResult result;
    for (int i = 0; i < 6; ++i) result = detector.detect(texturedFrame(i, 2.0F, 2 * i));
    return result;
  };
  const MotionResult a = run(), b = run();
  EXPECT_EQ(cv::norm(a.dynamic, b.dynamic, cv::NORM_INF), 0.0);
  EXPECT_EQ(cv::norm(a.flow_px, b.flow_px, cv::NORM_INF), 0.0);
  EXPECT_TRUE(a.T_current_previous.isApprox(b.T_current_previous, 0.0));
}

TEST(MotionDetectorTest, RefusesConfigurationsOutOfRange) {
  MotionConfig config;
  config.homography.theta_px = -1.0;
  EXPECT_THROW(MotionDetector{config}, ConfigError);
  config = MotionConfig();
  config.model = "magic";
  EXPECT_THROW(MotionDetector{config}, ConfigError);
}

}  // namespace
}  // namespace semantic_vslam
