// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/motion/label_memory.h"

#include <gtest/gtest.h>

#include <memory>

#include "core/support/quarter_vga.h"

namespace semantic_vslam {
namespace {

/// A desk front 1.5 m before a camera that moves to the right, and what a network says of it.
class LabelMemoryTest : public testing::Test {
 protected:
  static constexpr float kDeskM = 1.5F;
  static constexpr double kOneOfTwo = 0.8125;  // 0.5 at a third of the votes, 1 at six tenths

  PlacedFrame desk(double seconds, double right_m = 0.0) const {
    const cv::Mat1f depth_m(grid.size(), kDeskM);
    PlacedFrame place{Stamp::fromSeconds(seconds), depth_m, depth_m, SE3::Identity()};
    place.T_odometry_camera.translation().x() = right_m;
    return place;
  }
  cv::Mat1f everywhere(float dynamic) const { return cv::Mat1f(grid.size(), dynamic); }
  float weighed(float dynamic, const PlacedFrame& place, cv::Point cell) {
    return memory.weigh(everywhere(dynamic), place, grid, config)(cell);
  }

  WorkGrid grid{std::make_shared<const CameraModel>(quarterVga()), 160};
  const cv::Point middle{grid.size().width / 2, grid.size().height / 2};
  const RigidFlowConfig config;
  LabelMemory memory;
};

TEST_F(LabelMemoryTest, OneMistakeIsOutvotedAndAMajorityIsBelieved) {
  EXPECT_FLOAT_EQ(weighed(0.0F, desk(0.0), middle), 0.0F);
  EXPECT_FLOAT_EQ(weighed(0.0F, desk(1.0), middle), 0.0F);
  EXPECT_FLOAT_EQ(weighed(0.0F, desk(2.0), middle), 0.0F);
  EXPECT_LT(weighed(1.0F, desk(3.0), middle), 0.5F) << "one of four";
  EXPECT_GT(weighed(1.0F, desk(4.0), middle), 0.5F) << "two of five";
  EXPECT_LT(weighed(1.0F, desk(5.0), middle), 1.0F) << "three of six";
  for (const double seconds : {6.0, 7.0}) weighed(1.0F, desk(seconds), middle);
  EXPECT_FLOAT_EQ(weighed(1.0F, desk(8.0), middle), 1.0F) << "six of seven: the oldest two are forgotten";
}

TEST_F(LabelMemoryTest, ThePlaceIsFoundAgainAfterTheCameraHasMoved) {
  cv::Mat1f left_half = everywhere(0.0F);
  left_half(cv::Rect(0, 0, middle.x, grid.size().height)) = 1.0F;
  memory.weigh(left_half, desk(0.0), grid, config);
  // 0.3 m to the right at 1.5 m: the edge lies a fifth of the focal length farther left.
  const int edge = middle.x - static_cast<int>(0.2F * grid.focalCells());
  const cv::Mat1f mean = memory.weigh(everywhere(0.9F), desk(1.0, 0.3), grid, config);
  EXPECT_NEAR(mean(middle.y, edge - 2), 1.0, 1e-5);
  EXPECT_LT(mean(middle.y, edge + 2), 0.8);
  EXPECT_FLOAT_EQ(mean(middle.y, grid.size().width - 1), 0.9F) << "was not in view, nobody votes";
}

TEST_F(LabelMemoryTest, WhoStepsInFrontIsBelievedAtOnce) {
  for (const double seconds : {0.0, 1.0, 2.0}) weighed(0.0F, desk(seconds), middle);
  PlacedFrame person = desk(3.0);
  person.depth_m = person.surface_m = cv::Mat1f(grid.size(), kDeskM - 0.3F);
  EXPECT_FLOAT_EQ(weighed(1.0F, person, middle), 1.0F);
  EXPECT_LT(weighed(1.0F, desk(4.0), middle), 0.5F) << "the desk behind is still known when the person has gone";
}

TEST_F(LabelMemoryTest, AHoleIsTheHoleThatWasThere) {
  PlacedFrame screen = desk(0.0);
  screen.depth_m = screen.depth_m.clone();  // the surroundings stay
  screen.depth_m(middle) = 0.0F;
  weighed(0.0F, screen, middle);
  screen.stamp = Stamp::fromSeconds(1.0);
  EXPECT_NEAR(weighed(1.0F, screen, middle), kOneOfTwo, 1e-5);
  EXPECT_FLOAT_EQ(weighed(1.0F, desk(2.0), middle), 1.0F) << "a surface where there was none is new";
}

TEST_F(LabelMemoryTest, HoldsForTenSecondsAndNoLonger) {
  weighed(0.0F, desk(0.0), middle);
  EXPECT_NEAR(weighed(1.0F, desk(9.9), middle), kOneOfTwo, 1e-5);
  weighed(0.0F, desk(20.0), middle);
  EXPECT_FLOAT_EQ(weighed(1.0F, desk(30.1), middle), 1.0F);
  weighed(0.0F, desk(30.8), middle);
  memory.clear();
  EXPECT_FLOAT_EQ(weighed(1.0F, desk(31.5), middle), 1.0F);
}

TEST_F(LabelMemoryTest, LabelsInQuickSuccessionCountOnce) {
  for (int i = 0; i < 5; ++i) weighed(0.0F, desk(0.05 * i), middle);
  EXPECT_NEAR(weighed(1.0F, desk(0.3), middle), kOneOfTwo, 1e-5);
}

}  // namespace
}  // namespace semantic_vslam
