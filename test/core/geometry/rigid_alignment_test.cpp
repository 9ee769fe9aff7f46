// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/rigid_alignment.h"

#include <gtest/gtest.h>

#include "core/common/rng.h"

namespace semantic_vslam {
namespace {

std::vector<Eigen::Vector3d> randomPoints(int count, double flatness) {
  Rng rng(1);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < count; ++i) {
    points.emplace_back(rng.uniform(-2, 2), rng.uniform(-1, 1), flatness * rng.uniform(-1, 1));
  }
  return points;
}

std::vector<Eigen::Vector3d> transformed(const std::vector<Eigen::Vector3d>& points, const SE3& T, double scale) {
  std::vector<Eigen::Vector3d> out;
  for (const auto& point : points) out.push_back(T.linear() * (scale * point) + T.translation());
  return out;
}

const SE3 kMotion = se3Exp((Vector6d() << 1.0, -2.0, 0.5, 2.0, -1.0, 0.7).finished());

TEST(AlignPoints, RecoversARigidMotion) {
  const auto source = randomPoints(20, 1.0);
  const auto alignment = alignPoints(source, transformed(source, kMotion, 1.0));
  EXPECT_TRUE(alignment.T_target_source.isApprox(kMotion, 1e-12));
  EXPECT_EQ(alignment.scale, 1.0);
  EXPECT_TRUE(alignment.rotation_determined);
}

TEST(AlignPoints, RecoversScaleOnlyIfAsked) {
  const auto source = randomPoints(20, 1.0);
  const auto target = transformed(source, kMotion, 2.5);
  const auto alignment = alignPoints(source, target, true);
  EXPECT_NEAR(alignment.scale, 2.5, 1e-12);
  EXPECT_TRUE(alignment.T_target_source.isApprox(kMotion, 1e-12));
  EXPECT_TRUE(alignment.apply(source[3]).isApprox(target[3], 1e-12));
  EXPECT_EQ(alignPoints(source, target).scale, 1.0);
}

TEST(AlignPoints, PointsInAPlaneGiveARotationNotAReflection) {
  const auto source = randomPoints(12, 0.0);
  const auto alignment = alignPoints(source, transformed(source, kMotion, 1.0));
  EXPECT_NEAR(alignment.T_target_source.linear().determinant(), 1.0, 1e-12);
  EXPECT_TRUE(alignment.T_target_source.isApprox(kMotion, 1e-9));
  EXPECT_TRUE(alignment.rotation_determined);
}

TEST(AlignPoints, MirroredPointsStillGiveARotation) {
  const auto source = randomPoints(20, 1.0);
  auto target = source;
  for (auto& point : target) point.x() = -point.x();
  EXPECT_NEAR(alignPoints(source, target).T_target_source.linear().determinant(), 1.0, 1e-12);
}

TEST(AlignPoints, PointsOnALineAreFittedButNotDetermined) {
  std::vector<Eigen::Vector3d> source;
  for (int i = 0; i < 10; ++i) source.emplace_back(0.1 * i, 0.2 * i, 0.0);
  const auto target = transformed(source, kMotion, 1.0);
  const auto alignment = alignPoints(source, target);
  EXPECT_FALSE(alignment.rotation_determined);
  for (std::size_t i = 0; i < source.size(); ++i) EXPECT_TRUE(alignment.apply(source[i]).isApprox(target[i], 1e-9));
  EXPECT_FALSE(alignPoints({{1, 2, 3}}, {{4, 5, 6}}).rotation_determined);
}

TEST(AlignPoints, NoiseIsAveraged) {
  Rng rng(7);
  const auto source = randomPoints(2000, 1.0);
  auto target = transformed(source, kMotion, 1.0);
  for (auto& point : target) point += 0.01 * Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal());
  const auto alignment = alignPoints(source, target);
  // 1 cm a point, 2000 points: the mean is good to 0.01 / sqrt(2000) = 0.22 mm.
  EXPECT_LT((alignment.T_target_source.translation() - kMotion.translation()).norm(), 0.001);
  EXPECT_LT(rotationAngle(alignment.T_target_source.inverse() * kMotion), 0.001);
}

}  // namespace
}  // namespace semantic_vslam
