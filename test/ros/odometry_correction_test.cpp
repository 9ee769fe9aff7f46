// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/odometry_correction.h"

#include <gtest/gtest.h>

#include "ros/conversions.h"

namespace semantic_vslam {
namespace {

constexpr double kFrameS = 1.0 / 30.0;

SE3 along(double x_m) {
  SE3 T = SE3::Identity();
  T.translation().x() = x_m;
  return T;
}

/// A robot that drives at 1 m/s; its odometry starts at 0 and drifts by a tenth. Frame i is taken at timeOf(i).
class OdometryCorrectionTest : public testing::Test {
 protected:
  static ros::Time timeOf(int frame) { return ros::Time(100.0 + kFrameS * frame); }
  static double truthX(int frame) { return kFrameS * frame; }
  static double odometryX(int frame) { return 1.1 * truthX(frame); }
  /// @return what is given when the odometry of that frame arrives
  std::optional<OdometryCorrection::Edge> odometryArrives(int frame) {
    geometry_msgs::TransformStamped odometry;
    odometry.header.stamp = timeOf(frame);
    odometry.header.frame_id = "odom";
    odometry.child_frame_id = "base";
    odometry.transform = toTransform(along(odometryX(frame)));
    tf_.setTransform(odometry, "test");
    return correction_.update();
  }
  std::optional<OdometryCorrection::Edge> frameArrives(int frame) {
    return correction_.add(timeOf(frame), along(truthX(frame)));
  }
  /// Checks that an edge brings the odometry of `of` to the truth, and is stamped as `frame`.
  static void expectEdge(const std::optional<OdometryCorrection::Edge>& edge, int frame, int of) {
    ASSERT_TRUE(edge) << frame;
    EXPECT_EQ(edge->stamp, timeOf(frame));
    EXPECT_NEAR(edge->T_map_odom.translation().x(), truthX(of) - odometryX(of), 1e-9) << frame;
  }

  tf2::BufferCore tf_;
  OdometryCorrection correction_{tf_, "odom", "base"};
};

TEST_F(OdometryCorrectionTest, IsExactWhereOdometryIsThere) {
  for (int frame = 0; frame < 5; ++frame) {
    EXPECT_FALSE(odometryArrives(frame));
    expectEdge(frameArrives(frame), frame, frame);
    EXPECT_EQ(correction_.behindS(), 0.0);
  }
}

TEST_F(OdometryCorrectionTest, IsExactWhereOdometryComesBeforeTheNextFrame) {
  for (int frame = 0; frame < 5; ++frame) {
    EXPECT_FALSE(frameArrives(frame)) << "it is awaited";
    expectEdge(odometryArrives(frame), frame, frame);
    EXPECT_FALSE(correction_.update()) << "once";
  }
}

TEST_F(OdometryCorrectionTest, WhereOdometryIsLateEachFrameGetsTheLastEdge) {
  constexpr int kLate = 4;  // frames: 133 ms
  int given = 0;
  for (int frame = 0; frame < 39; ++frame) {
    if (frame >= kLate) odometryArrives(frame - kLate);
    const auto edge = frameArrives(frame);
    if (frame > kLate) expectEdge(edge, frame, frame - kLate);
    given += edge ? 1 : 0;
  }
  EXPECT_EQ(given, 39 - kLate);
}

TEST_F(OdometryCorrectionTest, GoesOnWhenOdometryDiesAndIsExactOnceItIsBack) {
  for (int frame = 0; frame < 3; ++frame) {
    odometryArrives(frame);
    frameArrives(frame);
  }
  EXPECT_FALSE(frameArrives(3)) << "it may come yet";
  for (int frame = 4; frame < 200; ++frame) expectEdge(frameArrives(frame), frame, 2);
  EXPECT_NEAR(correction_.behindS(), 197 * kFrameS, 1e-6);
  odometryArrives(200);
  expectEdge(frameArrives(200), 200, 200);
  EXPECT_EQ(correction_.behindS(), 0.0);
}

TEST_F(OdometryCorrectionTest, NothingIsMadeUpWhereThereWasNoOdometryYet) {
  for (int frame = 0; frame < 30; ++frame) EXPECT_FALSE(frameArrives(frame));
  EXPECT_NEAR(correction_.behindS(), 29 * kFrameS, 1e-6);
}

TEST_F(OdometryCorrectionTest, GoesOnAfterAClockThatIsSetBack) {
  odometryArrives(95);
  odometryArrives(100);
  expectEdge(frameArrives(100), 100, 100);
  expectEdge(frameArrives(95), 95, 95);
  EXPECT_FALSE(frameArrives(90)) << "older than all that is known of odometry";
  expectEdge(frameArrives(91), 91, 95);
}

}  // namespace
}  // namespace semantic_vslam
