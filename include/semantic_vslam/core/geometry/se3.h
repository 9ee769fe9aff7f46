// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace semantic_vslam {

/// Rigid motion. `T_a_b` maps points in b to points in a: `p_a = T_a_b * p_b`.
using SE3 = Eigen::Isometry3d;
/// Tangent vector: translation (m) first, rotation (rad) second.
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// Cross-product matrix: skew(a) * b = a x b.
Eigen::Matrix3d skew(const Eigen::Vector3d& v);

/// Rotation vector (rad) to rotation matrix and back, by Rodrigues' formula; the angle is in [0, pi].
Eigen::Matrix3d so3Exp(const Eigen::Vector3d& rotation_vector);
Eigen::Vector3d so3Log(const Eigen::Matrix3d& rotation);

/// Left Jacobian of SO(3) and its inverse: exp(w + dw) = exp(J(w) dw) exp(w) to first order (Barfoot 2017,
/// section 7.1).
Eigen::Matrix3d so3LeftJacobian(const Eigen::Vector3d& rotation_vector);
Eigen::Matrix3d so3LeftJacobianInverse(const Eigen::Vector3d& rotation_vector);

/// Exponential and logarithm of SE(3) (Barfoot 2017, section 7.1).
SE3 se3Exp(const Vector6d& tangent);
Vector6d se3Log(const SE3& transform);

/// @return rotation angle of the transform in rad, in [0, pi].
double rotationAngle(const SE3& transform);

/// Isometry from parts; the quaternion is normalised.
SE3 makeSE3(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& translation);

/// Interpolates along the geodesic. @param fraction 0 gives a, 1 gives b; outside extrapolates.
SE3 interpolate(const SE3& a, const SE3& b, double fraction);

}  // namespace semantic_vslam
