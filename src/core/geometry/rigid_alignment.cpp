// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/rigid_alignment.h"

#include <Eigen/SVD>
#include <cassert>

namespace semantic_vslam {
namespace {

// Points count as on one line if their second spread is this small against the first: 1 mm on 1 m.
constexpr double kLineRatio = 1e-3;

Eigen::Vector3d meanOf(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& point : points) sum += point;
  return sum / static_cast<double>(points.size());
}

}  // namespace

PointAlignment alignPoints(const std::vector<Eigen::Vector3d>& source, const std::vector<Eigen::Vector3d>& target,
                           bool with_scale) {
  assert(source.size() == target.size() && !source.empty());
  const double count = static_cast<double>(source.size());
  const Eigen::Vector3d source_mean = meanOf(source), target_mean = meanOf(target);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // eq. (38)
  double source_variance = 0.0;                          // eq. (36)
  for (std::size_t i = 0; i < source.size(); ++i) {
    covariance += (target[i] - target_mean) * (source[i] - source_mean).transpose() / count;
    source_variance += (source[i] - source_mean).squaredNorm() / count;
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d sign(1.0, 1.0, 1.0);  // eq. (39): a rotation, not a reflection
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0) sign.z() = -1.0;

  PointAlignment alignment;
  const Eigen::Vector3d& spread = svd.singularValues();
  alignment.rotation_determined = spread[0] > 0.0 && spread[1] > kLineRatio * kLineRatio * spread[0];
  if (with_scale && source_variance > 0.0) alignment.scale = spread.dot(sign) / source_variance;   // eq. (42)
  const Eigen::Matrix3d rotation = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();  // eq. (40)
  alignment.T_target_source.linear() = rotation;
  alignment.T_target_source.translation() = target_mean - alignment.scale * rotation * source_mean;  // eq. (41)
  return alignment;
}

}  // namespace semantic_vslam
