// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "eval/room_truth.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/dense/voxel_key.h"

namespace semantic_vslam {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using synthetic::Primitive;
using synthetic::Shape;

constexpr double kCellM = 0.3;

double distanceToBox(const Vector3d& p, const Vector3d& half) {
  const Vector3d q = p.cwiseAbs() - half;
  return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
}

/// First order: the shape's level sets are ellipsoids, whose distance is the level over its gradient.
double distanceToEllipsoid(const Vector3d& p, const Vector3d& radii) {
  const Vector3d unit = p.cwiseQuotient(radii);
  const double level = unit.norm(), slope = unit.cwiseQuotient(radii).norm();
  return slope < 1e-9 ? -radii.minCoeff() : level * (level - 1.0) / slope;
}

double distanceToSegment(const Vector2d& p, const Vector2d& a, const Vector2d& b) {
  const double along = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (p - a - along * (b - a)).norm();
}

/// @param p  distance to the axis and height along it
double distanceToFrustum(const Vector2d& p, double radius_low, double radius_high, double half_height) {
  const Vector2d low(radius_low, -half_height), high(radius_high, half_height);
  const double nearest = std::min({distanceToSegment(p, {0.0, -half_height}, low), distanceToSegment(p, low, high),
                                   distanceToSegment(p, high, {0.0, half_height})});
  const double share = (p.y() + half_height) / (2.0 * half_height);
  const bool inside = share >= 0.0 && share <= 1.0 && p.x() <= radius_low + share * (radius_high - radius_low);
  return inside ? -nearest : nearest;
}

/// Hull of two spheres on the axis: the nearest of all the spheres between them counts.
double distanceToRoundedCone(const Vector2d& p, double radius_low, double radius_high, double length) {
  const double sine = std::clamp((radius_low - radius_high) / length, -0.999, 0.999);
  const double foot = p.y() - p.x() * sine / std::sqrt(1.0 - sine * sine);
  const double share = std::clamp(foot / length, 0.0, 1.0);
  return (p - Vector2d(0.0, share * length)).norm() - radius_low - share * (radius_high - radius_low);
}

std::uint64_t cellKey(const Vector3d& point) { return voxelKey(voxelIndexAt(point, kCellM)); }

}  // namespace

double signedDistance(const Primitive& solid, const Vector3d& point) {
  const Vector3d p = (solid.T_world_local.inverse() * point.cast<float>()).cast<double>();
  const Vector3d scale = solid.scale.cast<double>();
  // Round shapes are measured in metres of x; y is brought to that.
  const double from_axis = std::hypot(p.x(), p.y() * scale.x() / scale.y());
  const double low = solid.radius_start * scale.x(), high = solid.radius_end * scale.x();
  switch (solid.shape) {
    case Shape::kBox: return distanceToBox(p, scale);
    case Shape::kEllipsoid: return distanceToEllipsoid(p, scale);
    case Shape::kFrustum: return distanceToFrustum({from_axis, p.z()}, low, high, scale.z());
    case Shape::kRoundedCone: return distanceToRoundedCone({from_axis, p.z()}, low, high, solid.length * scale.z());
  }
  return 0.0;
}

RoomTruth::RoomTruth(synthetic::Primitives solids) : solids_(std::move(solids)) {
  for (std::size_t i = 0; i < solids_.size(); ++i) {
    Eigen::AlignedBox3d box;
    for (const auto& corner : solids_[i].localCorners()) box.extend(solids_[i].toWorld(corner).cast<double>());
    const Eigen::Vector3i first = voxelIndexAt(box.min().array() - kReachM, kCellM);
    const Eigen::Vector3i last = voxelIndexAt(box.max().array() + kReachM, kCellM);
    Eigen::Vector3i index;
    for (index.x() = first.x(); index.x() <= last.x(); ++index.x()) {
      for (index.y() = first.y(); index.y() <= last.y(); ++index.y()) {
        for (index.z() = first.z(); index.z() <= last.z(); ++index.z()) {
          const Vector3d middle = (index.cast<double>().array() + 0.5) * kCellM;
          if (signedDistance(solids_[i], middle) < kReachM + 0.87 * kCellM + 0.05) {
            cells_[voxelKey(index)].push_back(static_cast<int>(i));
          }
        }
      }
    }
  }
}

const std::vector<int>& RoomTruth::near(const Vector3d& point) const {
  static const std::vector<int> kNothing;
  const auto found = cells_.find(cellKey(point));
  return found == cells_.end() ? kNothing : found->second;
}

RoomTruth::Nearest RoomTruth::nearest(const Vector3d& point) const {
  Nearest best;
  for (const int i : near(point)) {
    const double distance_m = std::abs(signedDistance(solids_[i], point));
    if (distance_m < best.distance_m) best = {distance_m, solids_[i].label, solids_[i].thing};
  }
  return best;
}

bool RoomTruth::obstacleOver(double x_m, double y_m, double low_m, double high_m) const {
  constexpr double kStepM = 0.01;  // the thinnest shelf is thicker
  for (double z_m = low_m; z_m <= high_m; z_m += kStepM) {
    const Vector3d point(x_m, y_m, z_m);
    const std::vector<int>& solids = near(point);
    if (std::any_of(solids.begin(), solids.end(), [&](int i) { return signedDistance(solids_[i], point) <= 0.0; })) {
      return true;
    }
  }
  return false;
}

}  // namespace semantic_vslam
