// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "semantic_vslam/core/camera/rgbd_frame.h"

#include <gtest/gtest.h>

#include <limits>

#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

std::shared_ptr<const CameraModel> smallCamera() {
  CameraIntrinsics k;
  k.width = 8;
  k.height = 6;
  k.fx = k.fy = 8;
  k.cx = 4;
  k.cy = 3;
  return std::make_shared<CameraModel>(k);
}

RgbdFrame make(const cv::Mat& bgr, const cv::Mat& depth, double unit_m = 0.001) {
  return makeRgbdFrame(0, Stamp{1}, bgr, depth, unit_m, smallCamera());
}

TEST(RgbdFrame, DepthUnitsGoByEncoding) {
  const cv::Mat bgr(6, 8, CV_8UC3, cv::Scalar(10, 20, 30));
  EXPECT_FLOAT_EQ(make(bgr, cv::Mat(6, 8, CV_16UC1, cv::Scalar(1500))).depth_m(2, 3), 1.5F);
  EXPECT_FLOAT_EQ(make(bgr, cv::Mat(6, 8, CV_16UC1, cv::Scalar(5000)), 0.0002).depth_m(2, 3), 1.0F);
  EXPECT_FLOAT_EQ(make(bgr, cv::Mat(6, 8, CV_32FC1, cv::Scalar(1.25))).depth_m(2, 3), 1.25F);
}

TEST(RgbdFrame, InvalidDepthBecomesZero) {
  cv::Mat1f depth(6, 8, 1.0F);
  depth(0, 0) = std::numeric_limits<float>::quiet_NaN();
  depth(0, 1) = std::numeric_limits<float>::infinity();
  depth(0, 2) = -1.0F;
  depth(0, 3) = 1000.0F;
  const RgbdFrame frame = make(cv::Mat(6, 8, CV_8UC3, cv::Scalar::all(0)), depth);
  for (int u = 0; u < 4; ++u) EXPECT_EQ(frame.depth_m(0, u), 0.0F);
  EXPECT_EQ(frame.depth_m(0, 4), 1.0F);
  EXPECT_TRUE(std::isnan(depth(0, 0))) << "the caller's image must not change";
}

TEST(RgbdFrame, WhatDoesNotFitIsNamed) {
  const cv::Mat bgr(6, 8, CV_8UC3, cv::Scalar::all(0));
  const cv::Mat depth(6, 8, CV_32FC1, cv::Scalar(1));
  EXPECT_THROW(make(cv::Mat(), depth), Error);
  EXPECT_THROW(make(bgr, cv::Mat()), Error);
  EXPECT_THROW(make(cv::Mat(7, 8, CV_8UC3), depth), Error);
  EXPECT_THROW(make(bgr, cv::Mat(6, 7, CV_32FC1)), Error);
  EXPECT_THROW(make(bgr, cv::Mat(6, 8, CV_8UC1)), Error);
  EXPECT_THROW(make(cv::Mat(6, 8, CV_16UC3), depth), Error);
}

TEST(RgbdFrame, GreyInputServesAsColour) {
  const RgbdFrame frame = make(cv::Mat(6, 8, CV_8UC1, cv::Scalar(77)), cv::Mat(6, 8, CV_32FC1, cv::Scalar(1)));
  EXPECT_EQ(frame.gray(1, 1), 77);
  EXPECT_EQ(frame.bgr(1, 1), cv::Vec3b(77, 77, 77));
}

}  // namespace
}  // namespace semantic_vslam
