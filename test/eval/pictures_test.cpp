// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "eval/cloud_view.h"
#include "eval/overview_picture.h"
#include "eval/plot_panel.h"
#include "eval/trajectory_plot.h"

namespace semantic_vslam {
namespace {

const cv::Vec3b kRed(0, 0, 255), kGreen(0, 255, 0);

std::shared_ptr<const CameraModel> camera() {
  CameraIntrinsics k;
  k.width = 64;
  k.height = 48;
  k.fx = k.fy = 50.0;
  k.cx = 31.0;
  k.cy = 23.0;
  return std::make_shared<CameraModel>(k);
}

LabelledPoint pointAt(float x_m, float y_m, float z_m, const cv::Vec3b& bgr) {
  LabelledPoint point;
  point.xyz_m = {x_m, y_m, z_m};
  point.bgr = bgr;
  return point;
}

cv::Vec3b ownColor(const LabelledPoint& point) { return point.bgr; }

int countColor(const cv::Mat3b& picture, const cv::Vec3b& bgr) {
  return static_cast<int>(std::count(picture.begin(), picture.end(), bgr));
}

TEST(RenderCloud, APointIsASquareOfItsSizeAtItsPixel) {
  // 10 cm at 1 m and 50 px focal length: 5 x 5 pixels around the principal point.
  const auto picture = renderCloud({pointAt(0, 0, 1, kRed)}, SE3::Identity(), *camera(), 0.1, ownColor);
  EXPECT_EQ(picture.size(), cv::Size(64, 48));
  EXPECT_EQ(countColor(picture, kRed), 25);
  EXPECT_EQ(picture(23, 31), kRed);
  EXPECT_EQ(picture(21, 29), kRed);
  EXPECT_NE(picture(20, 31), kRed);
}

TEST(RenderCloud, TheNearestPointWinsInAnyOrder) {
  const LabelledPoint near = pointAt(0, 0, 1, kRed), far = pointAt(0, 0, 2, kGreen);
  EXPECT_EQ(renderCloud({near, far}, SE3::Identity(), *camera(), 0.05, ownColor)(23, 31), kRed);
  EXPECT_EQ(renderCloud({far, near}, SE3::Identity(), *camera(), 0.05, ownColor)(23, 31), kRed);
}

TEST(RenderCloud, PointsBehindTheCameraAreNotSeen) {
  SE3 turned = SE3::Identity();
  turned.linear() = so3Exp({0.0, M_PI, 0.0});
  EXPECT_EQ(countColor(renderCloud({pointAt(0, 0, 1, kRed)}, turned, *camera(), 0.1, ownColor), kRed), 0);
}

TEST(AxisRange, HoldsAllValuesWithAMargin) {
  const AxisRange range = AxisRange::around({1.0, 3.0, 2.0}, 0.1);
  EXPECT_DOUBLE_EQ(range.low, 0.8);
  EXPECT_DOUBLE_EQ(range.high, 3.2);
  EXPECT_LT(AxisRange::around({2.0}, 0.1).low, AxisRange::around({2.0}, 0.1).high);
}

TEST(PlotPanel, ScalesMetresEquallyWhenAsked) {
  PlotCanvas canvas(cv::Size(600, 400));
  PlotPanel panel(canvas, cv::Rect(0, 0, 600, 400), {"title", "x (m)", "y (m)"}, {0, 1}, {0, 10}, true);
  // The axes are 400 - 82 px high for 10 m, so a metre is 31.8 px along x too.
  EXPECT_NEAR(panel.pixelsPerUnitX(), 31.8, 1e-9);
  panel.disc({0.5, 5.0}, 20.0, cv::Scalar(0, 0, 255));
  const cv::Mat3b picture = canvas.picture();
  EXPECT_EQ(picture.size(), cv::Size(600, 400));
  EXPECT_EQ(picture(34 + 159, 72 + 255), kRed) << "the middle of both ranges is the middle of the axes";
}

TEST(DrawTrajectoryComparison, ShowsBothPathsAndSurvivesDegenerateOnes) {
  std::vector<TimedPose> truth(50);
  for (int i = 0; i < 50; ++i) {
    truth[i].stamp = Stamp::fromSeconds(10.0 + 0.1 * i);
    truth[i].T_world_camera.translation() = Eigen::Vector3d(std::cos(0.1 * i), std::sin(0.1 * i), 0.0);
  }
  auto estimate = truth;
  for (int i = 0; i < 50; ++i) estimate[i].T_world_camera.translation().z() += 0.02 * std::sin(i);
  const cv::Mat3b picture = drawTrajectoryComparison(truth, absoluteTrajectoryError(truth, estimate), "test");
  EXPECT_EQ(picture.size(), cv::Size(1500, 1060));
  EXPECT_GT(countColor(picture, cv::Vec3b(190, 105, 20)), 100) << "the estimate's path";

  for (auto& pose : truth) pose.T_world_camera = SE3::Identity();  // standing still, without error
  EXPECT_FALSE(drawTrajectoryComparison(truth, absoluteTrajectoryError(truth, truth), "still").empty());
}

TEST(DrawOverview, ShowsMapSampleAndPathWithAndWithoutTruth) {
  OverviewContent content;
  content.title = "test";
  content.camera = camera();
  content.sample_bgr = cv::Mat3b(48, 64, cv::Vec3b(200, 200, 200));
  content.sample_dynamic = cv::Mat1b::zeros(48, 64);
  content.labels.classes.push_back({"wall", Mobility::kStatic, kGreen});
  for (int i = 0; i < 60; ++i) {
    for (int j = 0; j < 60; ++j) {
      content.cloud.push_back(
          pointAt(0.02F * static_cast<float>(i - 30), 0.02F * static_cast<float>(j - 30), 1.0F, kRed));
      content.cloud.back().label = 1;
    }
  }
  for (int i = 0; i < 20; ++i) {
    TimedPose pose;
    pose.stamp = Stamp::fromSeconds(10.0 + 0.1 * i);
    pose.T_world_camera.translation() = Eigen::Vector3d(0.01 * i, 0.005 * i * i, 0.0);
    content.trajectory.push_back(pose);
  }
  const cv::Mat3b without_truth = drawOverview(content);
  EXPECT_EQ(without_truth.size(), cv::Size(1640, 1200));
  EXPECT_GT(countColor(without_truth, kRed), 10000) << "the map from the sample's pose";
  EXPECT_GT(countColor(without_truth, kGreen), 10000) << "the same by label";

  content.truth = content.trajectory;
  content.absolute = absoluteTrajectoryError(content.truth, content.trajectory);
  EXPECT_FALSE(drawOverview(content).empty());
  EXPECT_FALSE(drawOverview(OverviewContent{}).empty()) << "a run that posed nothing";
}

TEST(DrawOverview, TakesPicturesOfAnyShape) {
  for (const cv::Size size : {cv::Size(480, 480), cv::Size(360, 480), cv::Size(640, 64), cv::Size(32, 512)}) {
    CameraIntrinsics k;
    k.width = size.width;
    k.height = size.height;
    k.fx = k.fy = 400.0;
    k.cx = 0.5 * size.width;
    k.cy = 0.5 * size.height;
    OverviewContent content;
    content.camera = std::make_shared<CameraModel>(k);
    content.sample_bgr = cv::Mat3b(size, kRed);
    content.sample_dynamic = cv::Mat1b::zeros(size);
    content.cloud = {pointAt(0, 0, 2, kGreen), pointAt(0.5, 0.5, 3, kGreen)};
    const cv::Mat3b picture = drawOverview(content);
    EXPECT_GT(countColor(picture, kRed), 2000) << size;
  }
}

TEST(DrawOverview, NamesAsManyLabelsAsThereIsRoomFor) {
  OverviewContent content;
  content.camera = camera();
  content.sample_bgr = cv::Mat3b(48, 64, cv::Vec3b(200, 200, 200));
  content.sample_dynamic = cv::Mat1b::zeros(48, 64);
  for (int label = 1; label <= 60; ++label) {
    content.labels.classes.push_back({"something with a long name " + std::to_string(label), Mobility::kStatic, kRed});
    content.cloud.push_back(
        pointAt(0.05F * static_cast<float>(label % 8), 0.05F * static_cast<float>(label / 8), 1.0F, kGreen));
    content.cloud.back().label = static_cast<std::uint8_t>(label);
  }
  EXPECT_EQ(drawOverview(content).size(), cv::Size(1640, 1200));
}

}  // namespace
}  // namespace semantic_vslam
