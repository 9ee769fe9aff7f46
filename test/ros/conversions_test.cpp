// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/conversions.h"

#include <gtest/gtest.h>
#include <sensor_msgs/image_encodings.h>
#include <sensor_msgs/point_cloud2_iterator.h>

#include <boost/make_shared.hpp>
#include <cmath>
#include <cstring>
#include <limits>

#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

namespace encodings = sensor_msgs::image_encodings;

sensor_msgs::ImagePtr makeImage(const std::string& encoding, int width, int height, int pixel_bytes) {
  auto image = boost::make_shared<sensor_msgs::Image>();
  image->encoding = encoding;
  image->width = width;
  image->height = height;
  image->step = width * pixel_bytes;
  image->data.resize(image->step * height);
  return image;
}

std::string errorOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

SE3 somePose() {
  return makeSE3(Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, -2, 0.5).normalized())),
                 {1.0, -2.0, 3.0});
}

TEST(Conversions, StampsKeepTheirNanoseconds) {
  const Stamp stamp{1305031102175304001};
  EXPECT_EQ(toRos(stamp).sec, 1305031102U);
  EXPECT_EQ(toRos(stamp).nsec, 175304001U);
  EXPECT_EQ(fromRos(toRos(stamp)), stamp);
}

TEST(Conversions, PosesSurviveTheWayThereAndBack) {
  EXPECT_TRUE(fromRos(toPose(somePose())).isApprox(somePose(), 1e-12));
  EXPECT_TRUE(fromRos(toTransform(somePose())).isApprox(somePose(), 1e-12));
}

TEST(Conversions, ForwardOfTheCameraIsForwardOfTheBody) {
  EXPECT_TRUE((bodyFromOptical() * Eigen::Vector3d::UnitZ()).isApprox(Eigen::Vector3d::UnitX()));
  EXPECT_TRUE((bodyFromOptical() * Eigen::Vector3d::UnitX()).isApprox(-Eigen::Vector3d::UnitY()));
  EXPECT_TRUE((bodyFromOptical() * Eigen::Vector3d::UnitY()).isApprox(-Eigen::Vector3d::UnitZ()));
  EXPECT_NEAR(bodyFromOptical().linear().determinant(), 1.0, 1e-12);
}

TEST(Conversions, LeadingSlashOfFrameNamesIsDropped) {
  EXPECT_EQ(frameName("/openni_rgb_optical_frame"), "openni_rgb_optical_frame");
  EXPECT_EQ(frameName("camera"), "camera");
  EXPECT_EQ(frameName(""), "");
}

TEST(Conversions, CovarianceOfTheBodyFollowsNumericDerivatives) {
  const SE3 T_map_world = somePose();
  const SE3 T_camera_world = makeSE3(Eigen::Quaterniond(0.9, 0.1, -0.2, 0.3), {0.4, 0.1, -0.6});
  const SE3 T_camera_body = makeSE3(Eigen::Quaterniond(0.5, 0.5, -0.5, 0.5), {0.1, 0.3, -0.2});
  const auto body = [&](const Vector6d& xi) {
    return SE3(T_map_world * (se3Exp(xi) * T_camera_world).inverse() * T_camera_body);
  };
  Matrix6d J;
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 6; ++i) {
    const SE3 moved = body(kStep * Vector6d::Unit(i)), still = body(Vector6d::Zero());
    J.col(i).head<3>() = (moved.translation() - still.translation()) / kStep;
    J.col(i).tail<3>() = so3Log(moved.linear() * still.linear().transpose()) / kStep;
  }
  Matrix6d covariance = Matrix6d::Zero();
  covariance.diagonal() << 1, 4, 9, 0.1, 0.2, 0.3;
  covariance(0, 4) = covariance(4, 0) = 0.2;
  const Matrix6d expected = J * covariance * J.transpose();
  const auto actual = bodyCovariance(covariance, T_map_world * T_camera_world.inverse(), T_camera_body);
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column) EXPECT_NEAR(actual[row * 6 + column], expected(row, column), 1e-4);
  }
}

sensor_msgs::CameraInfo calibratedInfo() {
  sensor_msgs::CameraInfo info;
  info.width = 640;
  info.height = 480;
  info.distortion_model = "plumb_bob";
  info.D = {0.26, -0.95, -0.005, 0.003, 1.16};
  info.K = {517.3, 0, 318.6, 0, 516.5, 255.3, 0, 0, 1};
  info.P = {520.0, 0, 320.0, 0, 0, 521.0, 240.0, 0, 0, 0, 1, 0};
  return info;
}

TEST(Conversions, RectifiedImagesTakeTheProjectionMatrixAndNoDistortion) {
  const CameraIntrinsics k = fromRos(calibratedInfo(), true);
  EXPECT_EQ(k.width, 640);
  EXPECT_EQ(k.height, 480);
  EXPECT_EQ(k.fx, 520.0);
  EXPECT_EQ(k.cy, 240.0);
  for (const double coefficient : k.distortion) EXPECT_EQ(coefficient, 0.0);
}

TEST(Conversions, RawImagesTakeTheCameraMatrixAndItsDistortion) {
  const CameraIntrinsics k = fromRos(calibratedInfo(), false);
  EXPECT_EQ(k.fx, 517.3);
  EXPECT_EQ(k.fy, 516.5);
  EXPECT_EQ(k.cx, 318.6);
  EXPECT_EQ(k.distortion[4], 1.16);
}

TEST(Conversions, RationalModelWithoutDenominatorIsPlumbBob) {
  sensor_msgs::CameraInfo info = calibratedInfo();
  info.distortion_model = "rational_polynomial";
  info.D = {0.1, 0.2, 0.3, 0.4, 0.5, 0, 0, 0};
  EXPECT_EQ(fromRos(info, false).distortion[4], 0.5);
  info.D[6] = 0.1;
  EXPECT_NE(errorOf([&] { fromRos(info, false); }).find("rational_polynomial"), std::string::npos);
}

TEST(Conversions, UncalibratedCameraIsRefused) {
  EXPECT_NE(errorOf([] { fromRos(sensor_msgs::CameraInfo(), true); }).find("uncalibrated"), std::string::npos);
  EXPECT_NE(errorOf([] { fromRos(sensor_msgs::CameraInfo(), false); }).find("uncalibrated"), std::string::npos);
}

TEST(Conversions, WhereOneMatrixIsFilledInAndNothingIsDistortedThatOneHolds) {
  sensor_msgs::CameraInfo info = calibratedInfo();
  info.P.fill(0.0);
  EXPECT_NE(errorOf([&] { fromRos(info, true); }).find("uncalibrated"), std::string::npos) << "distorted";
  info.D.assign(5, 0.0);
  EXPECT_EQ(fromRos(info, true).fx, 517.3);
  info.P = calibratedInfo().P;
  info.K.fill(0.0);
  EXPECT_EQ(fromRos(info, false).fx, 520.0);
}

TEST(Conversions, RegionAndBinningOfTheSensorAreTakenInto) {
  sensor_msgs::CameraInfo info = calibratedInfo();
  info.roi.x_offset = 100;
  info.roi.y_offset = 40;
  info.roi.width = 400;
  info.roi.height = 300;
  info.binning_x = 2;
  const CameraIntrinsics k = fromRos(info, true);
  EXPECT_EQ(k.width, 200);
  EXPECT_EQ(k.height, 300);
  EXPECT_EQ(k.fx, 260.0);
  EXPECT_EQ(k.cx, 110.0);
  EXPECT_EQ(k.fy, 521.0);
  EXPECT_EQ(k.cy, 200.0);
}

TEST(Conversions, ImagesThatCvBridgeKnowsBecomeColour) {
  const auto bayer = makeImage(encodings::BAYER_RGGB8, 8, 8, 1), yuv = makeImage(encodings::YUV422, 8, 8, 2);
  EXPECT_EQ(colourFromRos(bayer).type(), CV_8UC3);
  EXPECT_EQ(colourFromRos(yuv).type(), CV_8UC3);
  const auto bgr = makeImage(encodings::TYPE_8UC3, 2, 1, 3);
  bgr->data = {10, 20, 30, 40, 50, 60};
  EXPECT_EQ(colourFromRos(bgr).at<cv::Vec3b>(0, 1), cv::Vec3b(40, 50, 60));
  EXPECT_EQ(depthFromRos(makeImage(encodings::MONO16, 2, 2, 2)).type(), CV_16UC1);
}

TEST(Conversions, RgbBecomesBgr) {
  const auto message = makeImage(encodings::RGB8, 2, 1, 3);
  message->data = {10, 20, 30, 40, 50, 60};
  const cv::Mat image = colourFromRos(message);
  ASSERT_EQ(image.type(), CV_8UC3);
  EXPECT_EQ(image.at<cv::Vec3b>(0, 1), cv::Vec3b(60, 50, 40));
}

TEST(Conversions, ColourImageOutlivesItsMessage) {
  auto message = makeImage(encodings::MONO8, 2, 2, 1);
  message->data = {1, 2, 3, 4};
  const cv::Mat image = colourFromRos(message);
  EXPECT_EQ(image.data, message->data.data()) << "not copied";
  message.reset();
  EXPECT_EQ(image.at<std::uint8_t>(1, 1), 4);
}

TEST(Conversions, DepthKeepsItsEncodingAsType) {
  EXPECT_EQ(depthFromRos(makeImage(encodings::TYPE_32FC1, 3, 2, 4)).type(), CV_32FC1);
  const auto millimetres = makeImage(encodings::TYPE_16UC1, 2, 1, 2);
  const std::uint16_t depth_mm = 1234;
  std::memcpy(&millimetres->data[2], &depth_mm, sizeof depth_mm);
  EXPECT_EQ(depthFromRos(millimetres).at<std::uint16_t>(0, 1), 1234);
}

TEST(Conversions, WrongEncodingsAreNamed) {
  EXPECT_NE(errorOf([] { colourFromRos(makeImage("bayer_rggb16", 2, 2, 2)); }).find("bayer_rggb16"), std::string::npos);
  EXPECT_NE(errorOf([] { depthFromRos(makeImage("mono8", 2, 2, 1)); }).find("mono8"), std::string::npos);
  EXPECT_NE(errorOf([] { maskFromRos(makeImage("rgb8", 2, 2, 3)); }).find("rgb8"), std::string::npos);
}

TEST(Conversions, ImageWithTooFewBytesIsRefused) {
  const auto message = makeImage(encodings::BGR8, 4, 4, 3);
  message->data.resize(10);
  EXPECT_NE(errorOf([&] { colourFromRos(message); }), "");
}

TEST(Conversions, LabelSetSurvivesTheWayThereAndBack) {
  LabelSet labels;
  labels.classes.push_back({"person", Mobility::kPerson, cv::Vec3b(1, 128, 255)});
  labels.classes.push_back({"chair", Mobility::kMovable, cv::Vec3b(7, 8, 9)});
  const LabelSet back = fromRos(toRos(labels));
  ASSERT_EQ(back.size(), labels.size());
  for (std::size_t i = 0; i < labels.size(); ++i) {
    EXPECT_EQ(back.classes[i].name, labels.classes[i].name);
    EXPECT_EQ(back.classes[i].mobility, labels.classes[i].mobility);
    EXPECT_EQ(back.classes[i].color_bgr, labels.classes[i].color_bgr);
  }
}

TEST(Conversions, LabelledCloudHasColourAsRvizReadsItAndLabels) {
  LabelledPoint point;
  point.xyz_m = cv::Vec3f(1, 2, 3);
  point.bgr = cv::Vec3b(10, 20, 30);
  point.label = 4;
  const auto cloud = toRos({point, point}, std_msgs::Header());
  ASSERT_EQ(cloud->width, 2U);
  EXPECT_EQ(cloud->data.size(), cloud->row_step);
  sensor_msgs::PointCloud2ConstIterator<float> z(*cloud, "z");
  sensor_msgs::PointCloud2ConstIterator<std::uint8_t> r(*cloud, "r"), b(*cloud, "b"), label(*cloud, "label");
  ++z, ++r, ++b, ++label;
  EXPECT_EQ(*z, 3.0F);
  EXPECT_EQ(*r, 30);
  EXPECT_EQ(*b, 10);
  EXPECT_EQ(*label, 4);
}

TEST(Conversions, KeyframesKeepIdStampAndPose) {
  KeyframePoseArray message;
  message.keyframes.push_back(toRos(KeyframePose{KeyframeId(7), Stamp{123456789012}, somePose()}, "map", 3));
  EXPECT_EQ(message.keyframes[0].header.frame_id, "map");
  EXPECT_EQ(message.keyframes[0].map_id, 3U);
  message.map_id = 3;
  message.keyframes.push_back(toRos(KeyframePose{KeyframeId(8), Stamp{0}, SE3::Identity()}, "map", 3));
  message.keyframes.back().placed = false;
  const MapSnapshot back = fromRos(message);
  EXPECT_EQ(back.map_id, 3U);
  ASSERT_EQ(back.poses.size(), 1U);
  EXPECT_EQ(back.poses[0].keyframe, KeyframeId(7));
  EXPECT_EQ(back.poses[0].stamp, Stamp{123456789012});
  EXPECT_TRUE(back.poses[0].T_world_camera.isApprox(somePose(), 1e-12));
  EXPECT_EQ(back.unplaced, std::vector<KeyframeId>{KeyframeId(8)});
}

TEST(Conversions, AMotionReportKeepsAllButTheMask) {
  MotionResult motion;
  motion.model = MotionModel::kHomography;
  motion.inliers = 12;
  motion.told = false;
  motion.dynamic_share = 0.25;
  motion.labels = Stamp{5};
  motion.moving = cv::Mat1b(3, 4, std::uint8_t{0});
  motion.moving(1, 2) = 200;
  const MotionResult back = fromRos(boost::make_shared<MotionReport>(toRos(std_msgs::Header(), motion)));
  EXPECT_EQ(back.model, MotionModel::kHomography);
  EXPECT_EQ(back.inliers, 12);
  EXPECT_FALSE(back.told);
  EXPECT_EQ(back.dynamic_share, 0.25);
  EXPECT_EQ(back.labels, Stamp{5});
  EXPECT_EQ(cv::countNonZero(back.moving != motion.moving), 0);
  EXPECT_FALSE(fromRos(boost::make_shared<MotionReport>(toRos(std_msgs::Header(), MotionResult()))).labels);
}

}  // namespace
}  // namespace semantic_vslam
