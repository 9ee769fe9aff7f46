// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "core/optimization/pose_increment.h"
#include "semantic_vslam/core/geometry/se3.h"

namespace semantic_vslam {

/// How far two keyframes are from their measured relative pose, in sigmas: translation and rotation vector of
///     D = T_a_world * T_b_world^-1 * T_a_b^-1,
/// by the increments of both poses (PoseIncrement).
struct RelativePoseCost {
  SE3 T0_a_world, T0_b_world;  ///< poses around which increments are taken
  SE3 T_a_b;                   ///< measured
  double translation_sigma_m = 1.0, rotation_sigma_rad = 1.0;

  /// @param a, b  6 values each   @param residuals  6 values   @param by_a, by_b  row-major 6x6, or nullptr
  void evaluate(const double* a, const double* b, double* residuals, double* by_a, double* by_b) const {
    using RowMajor6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;
    const PoseIncrement increment_a(a), increment_b(b);
    const Eigen::Matrix3d R_a = increment_a.rotation() * T0_a_world.linear();
    const Eigen::Matrix3d R_b = increment_b.rotation() * T0_b_world.linear();
    const Eigen::Vector3d t_b = increment_b.apply(Eigen::Vector3d(T0_b_world.translation()));
    const SE3 T_b_a = T_a_b.inverse();
    const Eigen::Matrix3d R_ab = R_a * R_b.transpose();
    const Eigen::Vector3d rotated_a =
        R_ab * (T_b_a.translation() - t_b) + increment_a.rotation() * T0_a_world.translation();

    Eigen::Map<Vector6d> error(residuals);
    error.head<3>() = rotated_a + Eigen::Map<const Eigen::Vector3d>(a);
    error.tail<3>() = so3Log(R_ab * T_b_a.linear());
    const Eigen::Matrix3d log_jacobian = so3LeftJacobianInverse(error.tail<3>());
    Vector6d whitening;
    whitening << Eigen::Vector3d::Constant(1.0 / translation_sigma_m),
        Eigen::Vector3d::Constant(1.0 / rotation_sigma_rad);
    if (by_a != nullptr) {
      Eigen::Map<RowMajor6> j(by_a);
      j.setIdentity();
      j.topRightCorner<3, 3>() = -skew(rotated_a) * increment_a.rotationJacobian();
      j.bottomRightCorner<3, 3>() = log_jacobian * increment_a.rotationJacobian();
      j.bottomLeftCorner<3, 3>().setZero();
      j = whitening.asDiagonal() * j;
    }
    if (by_b != nullptr) {
      Eigen::Map<RowMajor6> j(by_b);
      const Eigen::Vector3d lever = T_b_a.translation() - Eigen::Map<const Eigen::Vector3d>(b);
      j.topLeftCorner<3, 3>() = -R_ab;
      j.topRightCorner<3, 3>() = R_ab * skew(lever) * increment_b.rotationJacobian();
      j.bottomLeftCorner<3, 3>().setZero();
      j.bottomRightCorner<3, 3>() = -log_jacobian * R_ab * increment_b.rotationJacobian();
      j = whitening.asDiagonal() * j;
    }
    error = whitening.asDiagonal() * error;
  }
};

}  // namespace semantic_vslam
