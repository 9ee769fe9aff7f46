// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "semantic_vslam/core/geometry/se3.h"

#include <cmath>

namespace semantic_vslam {
namespace {

// Below this angle the series are exact to double precision and the closed forms divide by nearly zero.
constexpr double kSmallAngle = 1e-5;

}  // namespace

Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

Eigen::Matrix3d so3Exp(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  const Eigen::Matrix3d W = skew(w);
  if (angle < kSmallAngle) return Eigen::Matrix3d::Identity() + W + 0.5 * W * W;
  return Eigen::Matrix3d::Identity() + std::sin(angle) / angle * W + (1.0 - std::cos(angle)) / (angle * angle) * W * W;
}

Eigen::Vector3d so3Log(const Eigen::Matrix3d& rotation) {
  Eigen::Quaterniond q(rotation);
  q.normalize();
  if (q.w() < 0) q.coeffs() *= -1;
  const double sine = q.vec().norm();
  if (sine < kSmallAngle) return 2.0 * q.vec();
  return 2.0 * std::atan2(sine, q.w()) / sine * q.vec();
}

Eigen::Matrix3d so3LeftJacobian(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  const Eigen::Matrix3d W = skew(w);
  if (angle < kSmallAngle) return Eigen::Matrix3d::Identity() + 0.5 * W + W * W / 6.0;
  const double angle2 = angle * angle;
  return Eigen::Matrix3d::Identity() + (1.0 - std::cos(angle)) / angle2 * W +
         (angle - std::sin(angle)) / (angle2 * angle) * W * W;
}

Eigen::Matrix3d so3LeftJacobianInverse(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  const Eigen::Matrix3d W = skew(w);
  if (angle < kSmallAngle) return Eigen::Matrix3d::Identity() - 0.5 * W + W * W / 12.0;
  const double half = 0.5 * angle;
  return Eigen::Matrix3d::Identity() - 0.5 * W + (1.0 - half / std::tan(half)) / (angle * angle) * W * W;
}

SE3 se3Exp(const Vector6d& tangent) {
  SE3 out = SE3::Identity();
  out.linear() = so3Exp(tangent.tail<3>());
  out.translation() = so3LeftJacobian(tangent.tail<3>()) * tangent.head<3>();
  return out;
}

Vector6d se3Log(const SE3& transform) {
  Vector6d out;
  out.tail<3>() = so3Log(transform.linear());
  out.head<3>() = so3LeftJacobian(out.tail<3>()).partialPivLu().solve(transform.translation());
  return out;
}

double rotationAngle(const SE3& transform) { return so3Log(transform.linear()).norm(); }

SE3 makeSE3(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& translation) {
  SE3 out = SE3::Identity();
  out.linear() = rotation.normalized().toRotationMatrix();
  out.translation() = translation;
  return out;
}

SE3 interpolate(const SE3& a, const SE3& b, double fraction) { return a * se3Exp(fraction * se3Log(a.inverse() * b)); }

}  // namespace semantic_vslam
