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

/// Voxels of 3 cm on a level square.
void addSquare(const Eigen::Vector3d& up, double height_m, double from_x_m, double side_m,
               std::vector<Eigen::Vector3d>& surface) {
  for (double x = from_x_m; x < from_x_m + side_m; x += 0.03) {
    for (double y = 0.0; y < side_m; y += 0.03) {
      surface.emplace_back(x, y, (height_m - up.x() * x - up.y() * y) / up.z());
    }
  }
}

TEST(FindFloor, IsTheLargestPlaneThatNothingLiesBelow) {
  const Eigen::Vector3d up = Eigen::Vector3d(0.05, -0.03, 1.0).normalized();
  std::vector<Eigen::Vector3d> surface;
  addSquare(up, -1.3, 1.0, 1.5, surface);
  addSquare(up, -0.55, 2.0, 2.5, surface);  // a table, larger than what is seen of the floor
  const std::optional<Floor> floor = findFloor(surface, 0.03);
  ASSERT_TRUE(floor);
  EXPECT_NEAR(floor->heightOf({1.5, 0.5, 0.0}), up.dot(Eigen::Vector3d(1.5, 0.5, 0.0)) + 1.3, 0.01);
  EXPECT_NEAR(floor->tiltDeg(), 3.3, 0.2);
}

TEST(FindFloor, FindsNoneInAWallOrASpeck) {
  std::vector<Eigen::Vector3d> wall, speck;
  for (double y = 0.0; y < 3.0; y += 0.03) {
    for (double z = 0.0; z < 2.0; z += 0.03) wall.emplace_back(2.0, y, z);
  }
  addSquare(Eigen::Vector3d::UnitZ(), 0.0, 0.0, 0.5, speck);
  EXPECT_FALSE(findFloor(wall, 0.03));
  EXPECT_FALSE(findFloor(speck, 0.03));
  EXPECT_FALSE(findFloor({}, 0.03));
}

}  // namespace
}  // namespace semantic_vslam
