// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "semantic_vslam/core/geometry/se3.h"

namespace semantic_vslam {

/// Left perturbation of a pose that an optimiser estimates, as the six numbers (translation m, rotation rad):
///     p_camera = exp(rotation) * (T0 * p_world) + translation.
/// A plain vector space, so it needs neither Ceres' LocalParameterization (1.14) nor its Manifold (2.1); to first order
/// at zero it is the left perturbation of SE(3), so covariances come out in the tangent of se3Exp().
class PoseIncrement {
 public:
  explicit PoseIncrement(const double* increment)
      : translation_(increment), vector_(increment + 3), rotation_(so3Exp(vector_)) {}

  Eigen::Vector3d apply(const Eigen::Vector3d& point) const { return rotation_ * point + translation_; }
  SE3 apply(const SE3& T0) const {
    SE3 out = SE3::Identity();
    out.linear() = Eigen::Quaterniond(rotation_ * T0.linear()).normalized().toRotationMatrix();
    out.translation() = apply(Eigen::Vector3d(T0.translation()));
    return out;
  }
  const Eigen::Matrix3d& rotation() const { return rotation_; }
  const Eigen::Vector3d& translation() const { return translation_; }
  /// Left Jacobian of the rotation, shared by the derivatives of all points: d(exp(w) p)/dw = -skew(exp(w) p) J(w).
  Eigen::Matrix3d rotationJacobian() const { return so3LeftJacobian(vector_); }

 private:
  Eigen::Vector3d translation_, vector_;
  Eigen::Matrix3d rotation_;
};

}  // namespace semantic_vslam
