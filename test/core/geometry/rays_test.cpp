// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/rays.h"

#include <gtest/gtest.h>

#include <cmath>

namespace semantic_vslam {
namespace {

Ray rayTo(const Eigen::Vector3d& origin, const Eigen::Vector3d& point) {
  return {origin, (point - origin).normalized()};
}

TEST(IntersectRays, FindsThePointThatBothRaysMeetIn) {
  const Eigen::Vector3d point(0.3, -0.2, 4.0);
  const auto found = intersectRays(rayTo({0, 0, 0}, point), rayTo({0.5, 0.1, -0.2}, point));
  ASSERT_TRUE(found);
  EXPECT_LT((*found - point).norm(), 1e-9);
}

TEST(IntersectRays, OfSkewRaysIsTheMiddleBetweenThem) {
  // Along x at z = 0 and along y at z = 1: closest at (2, 3, 0) and (2, 3, 1).
  const Ray a{{0, 3, 0}, Eigen::Vector3d::UnitX()}, b{{2, 0, 1}, Eigen::Vector3d::UnitY()};
  EXPECT_LT((*intersectRays(a, b) - Eigen::Vector3d(2, 3, 0.5)).norm(), 1e-12);
}

TEST(IntersectRays, RefusesParallelRaysAndPointsBehind) {
  EXPECT_FALSE(intersectRays({{0, 0, 0}, Eigen::Vector3d::UnitZ()}, {{1, 0, 0}, Eigen::Vector3d::UnitZ()}));
  const Eigen::Vector3d point(0, 0, 2);
  Ray away = rayTo({1, 0, 0}, point);
  away.direction_world *= -1;
  EXPECT_FALSE(intersectRays(rayTo({0, 0, 0}, point), away));
}

TEST(Parallax, IsTheAngleBetweenTheRays) {
  const Eigen::Vector3d point(0, 0, 1);
  EXPECT_NEAR(parallax(rayTo({0, 0, 0}, point), rayTo({1, 0, 0}, point)), M_PI / 4, 1e-12);
}

TEST(EssentialMatrix, HoldsForTheViewsOfOnePoint) {
  const SE3 T_b_a = se3Exp((Vector6d() << 0.4, -0.1, 0.2, 0.05, -0.3, 0.1).finished());
  const Eigen::Vector3d in_a(0.5, -0.3, 3.0), in_b = T_b_a * in_a;
  EXPECT_NEAR((in_b / in_b.z()).dot(essentialMatrix(T_b_a) * (in_a / in_a.z())), 0.0, 1e-12);
  const Eigen::Vector3d elsewhere = T_b_a * Eigen::Vector3d(0.5, 0.3, 3.0);
  EXPECT_GT(std::abs((elsewhere / elsewhere.z()).dot(essentialMatrix(T_b_a) * (in_a / in_a.z()))), 1e-3);
}

}  // namespace
}  // namespace semantic_vslam
