// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/tracking_markers.h"

#include <gtest/gtest.h>

#include "ros/conversions.h"

namespace semantic_vslam {
namespace {

TEST(KeyframeArrows, PointWhereTheCameraLooksAndLeaveOutWhatHasNoPlace) {
  KeyframePoseArray keyframes;
  keyframes.header.frame_id = "map";
  keyframes.keyframes.resize(2);
  SE3 T_map_camera = SE3::Identity();
  T_map_camera.linear() = so3Exp({0.3, -0.8, 0.1});
  T_map_camera.translation() = Eigen::Vector3d(1.0, 2.0, 3.0);
  keyframes.keyframes[0].pose = toPose(T_map_camera);
  keyframes.keyframes[0].placed = true;
  keyframes.keyframes[1].pose.orientation.w = 1.0;
  const geometry_msgs::PoseArray arrows = toPoseArray(keyframes);
  ASSERT_EQ(arrows.poses.size(), 1U);
  EXPECT_EQ(arrows.header.frame_id, "map");
  const SE3 arrow = fromRos(arrows.poses[0]);
  EXPECT_TRUE(arrow.translation().isApprox(T_map_camera.translation(), 1e-9));
  const Eigen::Vector3d looks_at = T_map_camera.linear().col(2), points_at = arrow.linear().col(0);
  EXPECT_TRUE(points_at.isApprox(looks_at, 1e-9)) << points_at.transpose();
}

TEST(StateMarker, IsGreenOnlyWhereThePlaceIsKnown) {
  geometry_msgs::Point camera;
  camera.z = 1.0;
  TrackingReport report;
  report.state = TrackingReport::OK;
  report.inliers = 312;
  const auto ok = toMarker(report, "OK", camera, "map");
  EXPECT_EQ(ok.header.frame_id, "map");
  EXPECT_EQ(ok.text, "OK, 312 points");
  EXPECT_GT(ok.color.g, ok.color.r);
  EXPECT_GT(ok.pose.position.z, camera.z);
  report.state = TrackingReport::LOST;
  const auto lost = toMarker(report, "LOST", camera, "map");
  EXPECT_EQ(lost.text, "LOST");
  EXPECT_LT(lost.color.g, lost.color.r);
}

}  // namespace
}  // namespace semantic_vslam
