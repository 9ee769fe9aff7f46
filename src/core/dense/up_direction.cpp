// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/dense/up_direction.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/common/rng.h"

namespace semantic_vslam {
namespace {

/// About `count` points, evenly out of all.
std::vector<Eigen::Vector3d> samplePositions(const std::vector<LabelledPoint>& cloud, std::size_t count) {
  std::vector<Eigen::Vector3d> sample;
  const std::size_t step = std::max<std::size_t>(1, cloud.size() / count);
  for (std::size_t i = 0; i < cloud.size(); i += step) sample.push_back(cloud[i].position());
  return sample;
}

struct Plane {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  double offset_m = 0.0;
  bool holds(const Eigen::Vector3d& p) const {
    constexpr double kThicknessM = 0.02;  // depth noise at 2-3 m
    return std::abs(normal.dot(p) - offset_m) < kThicknessM;
  }
};

Plane fitPlane(const std::vector<Eigen::Vector3d>& points, const Plane& initial) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector3d> held;
  std::copy_if(points.begin(), points.end(), std::back_inserter(held), [&](const auto& p) { return initial.holds(p); });
  for (const auto& p : held) mean += p / static_cast<double>(held.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const auto& p : held) scatter += (p - mean) * (p - mean).transpose();
  Plane plane;
  plane.normal = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvectors().col(0);
  if (plane.normal.dot(initial.normal) < 0.0) plane.normal = -plane.normal;
  plane.offset_m = plane.normal.dot(mean);
  return plane;
}

}  // namespace

Eigen::Vector3d estimateUpDirection(const std::vector<LabelledPoint>& cloud, const Eigen::Vector3d& prior_up) {
  constexpr int kTrials = 400;
  const double least_cosine = std::cos(50.0 * CV_PI / 180.0);
  const std::vector<Eigen::Vector3d> points = samplePositions(cloud, 3000);
  if (points.size() < 3) return prior_up;
  Rng rng(1);
  Plane best;
  std::ptrdiff_t most = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Eigen::Vector3d &a = points[rng.below(points.size())], &b = points[rng.below(points.size())],
                          &c = points[rng.below(points.size())];
    Plane plane;
    plane.normal = (b - a).cross(c - a);
    if (plane.normal.norm() < 1e-6) continue;
    plane.normal.normalize();
    if (plane.normal.dot(prior_up) < 0.0) plane.normal = -plane.normal;
    if (plane.normal.dot(prior_up) < least_cosine) continue;
    plane.offset_m = plane.normal.dot(a);
    const auto held = std::count_if(points.begin(), points.end(), [&](const auto& p) { return plane.holds(p); });
    if (held <= most) continue;
    most = held;
    best = plane;
  }
  if (most < static_cast<std::ptrdiff_t>(points.size() / 20)) return prior_up;
  return fitPlane(points, best).normal;
}

}  // namespace semantic_vslam
