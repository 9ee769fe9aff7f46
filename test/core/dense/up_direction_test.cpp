// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/dense/up_direction.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/common/rng.h"

namespace semantic_vslam {
namespace {

/// A floor of 2 m x 2 m with this normal (in the plane of y and z) (red, chair) with a wall of fewer points (blue,
/// background) at its end.
std::vector<LabelledPoint> floorAndWall(const Eigen::Vector3d& up) {
  const Eigen::Vector3d across = Eigen::Vector3d::UnitX(), along = across.cross(up).normalized();
  std::vector<LabelledPoint> cloud;
  const auto add = [&](const Eigen::Vector3d& p, const cv::Vec3b& bgr, std::uint8_t label) {
    cloud.push_back({cv::Vec3f(cv::Vec3d(p.x(), p.y(), p.z())), bgr, label});
  };
  for (int i = -100; i < 100; ++i) {
    for (int j = 0; j < 200; ++j) add(across * 0.01 * i + along * 0.01 * j - up, {0, 0, 200}, 2);
    for (int j = 0; j < 60; ++j) add(across * 0.01 * i + along * 2.0 + up * (0.01 * j - 1.0), {200, 0, 0}, 0);
  }
  return cloud;
}

TEST(EstimateUpDirection, IsTheNormalOfTheLargestFlatSurface) {
  const Eigen::Vector3d up = Eigen::Vector3d(0.0, -0.9, -0.4).normalized();
  const Eigen::Vector3d estimate = estimateUpDirection(floorAndWall(up), -Eigen::Vector3d::UnitY());
  EXPECT_LT(std::acos(std::min(1.0, estimate.dot(up))), 1e-3);
  EXPECT_EQ(estimate, estimateUpDirection(floorAndWall(up), -Eigen::Vector3d::UnitY()));
}

TEST(EstimateUpDirection, FallsBackOnThePriorWithoutAPlane) {
  Rng rng(3);
  std::vector<LabelledPoint> cloud(4000);
  for (auto& point : cloud) {
    point.xyz_m = cv::Vec3f(static_cast<float>(rng.uniform(-5, 5)), static_cast<float>(rng.uniform(-5, 5)),
                            static_cast<float>(rng.uniform(-5, 5)));
  }
  const Eigen::Vector3d prior = -Eigen::Vector3d::UnitY();
  EXPECT_EQ(estimateUpDirection(cloud, prior), prior);
  EXPECT_EQ(estimateUpDirection({}, prior), prior);
}

}  // namespace
}  // namespace semantic_vslam
