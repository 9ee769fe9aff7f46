// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "semantic_vslam/core/camera/camera_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

CameraIntrinsics freiburg1() {
  CameraIntrinsics k;
  k.fx = 517.306408;
  k.fy = 516.469215;
  k.cx = 318.643040;
  k.cy = 255.313989;
  k.distortion = {0.262383, -0.953104, -0.005358, 0.002628, 1.163314};
  return k;
}

TEST(CameraModel, ProjectsByHand) {
  CameraIntrinsics k;
  k.fx = 500;
  k.fy = 400;
  k.cx = 320;
  k.cy = 240;
  const CameraModel camera(k);
  // x/z = 0.1, y/z = -0.2: u = 500 * 0.1 + 320, v = 400 * -0.2 + 240.
  const Eigen::Vector2d px = camera.projectRaw({0.2, -0.4, 2.0});
  EXPECT_NEAR(px.x(), 370.0, 1e-12);
  EXPECT_NEAR(px.y(), 160.0, 1e-12);
  const Eigen::Vector3d back = camera.unprojectUndistorted(px, 2.0);
  EXPECT_TRUE(back.isApprox(Eigen::Vector3d(0.2, -0.4, 2.0), 1e-12));
}

TEST(CameraModel, RayOfARawPixelProjectsBackOntoIt) {
  const CameraModel camera(freiburg1());
  for (const auto& [u, v] : {std::pair(10, 10), std::pair(320, 240), std::pair(630, 20), std::pair(100, 470)}) {
    const cv::Vec2f& ray = camera.rays()(v, u);
    const Eigen::Vector2d px = camera.projectRaw(2.0 * Eigen::Vector3d(ray[0], ray[1], 1.0));
    EXPECT_NEAR(px.x(), u, 2e-3);
    EXPECT_NEAR(px.y(), v, 2e-3);
  }
}

TEST(CameraModel, UndistortAgreesWithIdealProjectionBetweenPixels) {
  const CameraModel camera(freiburg1());
  for (double x = -0.5; x <= 0.5; x += 0.07) {
    const Eigen::Vector3d point(x, 0.6 * x - 0.05, 1.3);
    const Eigen::Vector2d undistorted = camera.undistort(camera.projectRaw(point));
    EXPECT_LT((undistorted - camera.projectUndistorted(point)).norm(), 5e-3);
  }
}

TEST(CameraModel, RefusesIntrinsicsThatAreNoCamera) {
  CameraIntrinsics k = freiburg1();
  k.fx = 0.0;
  EXPECT_THROW(CameraModel{k}, ConfigError);
  k = freiburg1();
  k.width = 0;
  EXPECT_THROW(CameraModel{k}, ConfigError);
  k = freiburg1();
  k.distortion[2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(CameraModel{k}, ConfigError);
  for (double CameraIntrinsics::*value : {&CameraIntrinsics::fx, &CameraIntrinsics::fy, &CameraIntrinsics::cx}) {
    for (const double wrong : {1e-300, 1e9, -1e9, std::numeric_limits<double>::quiet_NaN()}) {
      if (value == &CameraIntrinsics::cx && wrong == 1e-300) continue;
      k = freiburg1();
      k.*value = wrong;
      EXPECT_THROW(CameraModel{k}, ConfigError) << wrong;
    }
  }
  k = freiburg1();
  k.width = k.height = 30000;  // a table of rays of 7 GB
  EXPECT_THROW(CameraModel{k}, ConfigError);
}

}  // namespace
}  // namespace semantic_vslam
