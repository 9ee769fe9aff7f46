// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/dense/up_direction.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>

#include "core/common/rng.h"

namespace semantic_vslam {
namespace {

using Points = std::vector<Eigen::Vector3d>;

/// About `count` points, evenly out of all.
template <class Item, class Position>
Points samplePositions(const std::vector<Item>& items, std::size_t count, Position position) {
  Points sample;
  const std::size_t step = std::max<std::size_t>(1, items.size() / count);
  for (std::size_t i = 0; i < items.size(); i += step) sample.push_back(position(items[i]));
  return sample;
}

struct Plane {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  double offset_m = 0.0;
  double heightOf(const Eigen::Vector3d& p) const { return normal.dot(p) - offset_m; }
};

/// Which planes are looked for, and how far their points may lie off.
struct PlaneSearch {
  Eigen::Vector3d prior_up;
  double most_tilt_deg;
  double thickness_m;
  /// Whether a plane with that many of the points may be the one.
  std::function<bool(const Plane&, std::ptrdiff_t held)> admits = [](const Plane&, std::ptrdiff_t) { return true; };
};

std::ptrdiff_t countHeld(const Points& points, const Plane& plane, double thickness_m) {
  return std::count_if(points.begin(), points.end(),
                       [&](const auto& p) { return std::abs(plane.heightOf(p)) < thickness_m; });
}

Plane fitPlane(const Points& points, const Plane& initial, double thickness_m) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Points held;
  std::copy_if(points.begin(), points.end(), std::back_inserter(held),
               [&](const auto& p) { return std::abs(initial.heightOf(p)) < thickness_m; });
  for (const auto& p : held) mean += p / static_cast<double>(held.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const auto& p : held) scatter += (p - mean) * (p - mean).transpose();
  Plane plane;
  plane.normal = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvectors().col(0);
  if (plane.normal.dot(initial.normal) < 0.0) plane.normal = -plane.normal;
  plane.offset_m = plane.normal.dot(mean);
  return plane;
}

/// The plane that holds most points among those admitted, fitted to them; with zero points where there is none.
std::pair<Plane, std::ptrdiff_t> largestPlane(const Points& points, const PlaneSearch& search) {
  constexpr int kTrials = 400;
  const double least_cosine = std::cos(search.most_tilt_deg * CV_PI / 180.0);
  Rng rng(1);
  Plane best;
  std::ptrdiff_t most = 0;
  for (int trial = 0; trial < kTrials && points.size() >= 3; ++trial) {
    const Eigen::Vector3d &a = points[rng.below(points.size())], &b = points[rng.below(points.size())],
                          &c = points[rng.below(points.size())];
    Plane plane;
    plane.normal = (b - a).cross(c - a);
    if (plane.normal.norm() < 1e-6) continue;
    plane.normal.normalize();
    if (plane.normal.dot(search.prior_up) < 0.0) plane.normal = -plane.normal;
    if (plane.normal.dot(search.prior_up) < least_cosine) continue;
    plane.offset_m = plane.normal.dot(a);
    const std::ptrdiff_t held = countHeld(points, plane, search.thickness_m);
    if (held <= most || !search.admits(plane, held)) continue;
    most = held;
    best = plane;
  }
  if (most > 0) best = fitPlane(points, best, search.thickness_m);
  return {best, most};
}

}  // namespace

Eigen::Vector3d estimateUpDirection(const std::vector<LabelledPoint>& cloud, const Eigen::Vector3d& prior_up) {
  constexpr double kThicknessM = 0.02;  // depth noise at 2-3 m
  const Points points = samplePositions(cloud, 3000, [](const LabelledPoint& p) { return p.position(); });
  const auto [plane, held] = largestPlane(points, {prior_up, 50.0, kThicknessM});
  return held == 0 || held < static_cast<std::ptrdiff_t>(points.size() / 20) ? prior_up : plane.normal;
}

double Floor::tiltDeg() const { return std::acos(std::clamp(up.z(), -1.0, 1.0)) * 180.0 / CV_PI; }

std::optional<Floor> findFloor(const std::vector<Eigen::Vector3d>& surface, double voxel_m) {
  constexpr double kMostTiltDeg = 20.0;  // a camera in the hand
  constexpr double kLeastM2 = 0.5;
  constexpr double kBelowM = 0.15, kMostBelow = 0.02;  // reflections and noise
  const Points points = samplePositions(surface, 4000, [](const Eigen::Vector3d& p) { return p; });
  if (points.empty()) return std::nullopt;
  const double m2_of_point =
      voxel_m * voxel_m * static_cast<double>(surface.size()) / static_cast<double>(points.size());
  PlaneSearch search{Eigen::Vector3d::UnitZ(), kMostTiltDeg, 0.6 * voxel_m};
  search.admits = [&](const Plane& plane, std::ptrdiff_t held) {
    if (static_cast<double>(held) * m2_of_point < kLeastM2) return false;
    const auto below =
        std::count_if(points.begin(), points.end(), [&](const auto& p) { return plane.heightOf(p) < -kBelowM; });
    return static_cast<double>(below) <= kMostBelow * static_cast<double>(points.size());
  };
  const auto [plane, held] = largestPlane(points, search);
  if (held == 0) return std::nullopt;
  // All of it, and what noise has moved off: far off the floor is seen under a few degrees.
  Plane whole = plane;
  for (int round = 0; round < 3; ++round) whole = fitPlane(surface, whole, 1.5 * voxel_m);
  return Floor{whole.normal, whole.offset_m};
}

}  // namespace semantic_vslam
