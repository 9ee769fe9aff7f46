// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/rays.h"

#include <algorithm>
#include <cmath>

namespace semantic_vslam {

double parallax(const Ray& a, const Ray& b) {
  return std::atan2(a.direction_world.cross(b.direction_world).norm(), a.direction_world.dot(b.direction_world));
}

std::optional<Eigen::Vector3d> intersectRays(const Ray& a, const Ray& b) {
  // The points a + s da and b + t db whose connection is at right angles to both directions.
  const Eigen::Vector3d between = b.origin_world - a.origin_world;
  const double cosine = a.direction_world.dot(b.direction_world);
  const double sine_squared = 1.0 - cosine * cosine;
  constexpr double kParallel = 1e-12;
  if (sine_squared < kParallel) return std::nullopt;
  const double along_a = between.dot(a.direction_world), along_b = between.dot(b.direction_world);
  const double s = (along_a - cosine * along_b) / sine_squared, t = (cosine * along_a - along_b) / sine_squared;
  if (s <= 0.0 || t <= 0.0) return std::nullopt;
  return 0.5 * (a.origin_world + s * a.direction_world + b.origin_world + t * b.direction_world);
}

Eigen::Matrix3d essentialMatrix(const SE3& T_b_a) { return skew(T_b_a.translation()) * T_b_a.linear(); }

}  // namespace semantic_vslam
