// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "semantic_vslam/core/optimization/pose_cost.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <utility>

namespace semantic_vslam {
namespace {

using Jacobian3x6 = Eigen::Matrix<double, 3, 6>;
using JacobianMap = Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, 6>>;

/// Robust residual of one point and, on request, its derivative.
void evaluatePoint(const VirtualStereo& camera, const PoseCost::Point& point, const PoseIncrement& increment,
                   const Eigen::Matrix3d& rotation_jacobian, Eigen::Vector3d* residual, Jacobian3x6* jacobian) {
  const Eigen::Vector3d rotated = increment.rotation() * point.point_camera;
  const Eigen::Vector3d p = increment.apply(point.point_camera);
  residual->setZero();
  if (jacobian != nullptr) jacobian->setZero();
  if (p.z() < kMinProjectionDepthM) return;

  const Eigen::Vector3d error = whitenedError(camera, point.measurement, p);
  const double root_weight = std::sqrt(point.measurement.weight);
  double scale_derivative = 0.0;
  const double scale = huberScale(error.squaredNorm(), point.measurement.chi2Bound(), &scale_derivative);
  *residual = root_weight * scale * error;
  if (jacobian == nullptr) return;

  Jacobian3x6 error_jacobian;
  error_jacobian.leftCols<3>() = whitenedErrorJacobian(camera, point.measurement, p);
  error_jacobian.rightCols<3>() = -error_jacobian.leftCols<3>() * skew(rotated) * rotation_jacobian;
  *jacobian = root_weight * scale * error_jacobian;
  if (scale_derivative != 0.0) {
    *jacobian += (root_weight * 2.0 * scale_derivative) * error * (error.transpose() * error_jacobian);
  }
}

/// Square root of a positive semi-definite matrix: information = root^T * root.
Matrix6d squareRoot(const Matrix6d& information) {
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(information);
  return solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() * solver.eigenvectors().transpose();
}

}  // namespace

PoseCost::PoseCost(const VirtualStereo& camera, const SE3& T0, std::vector<Point> points,
                   const std::optional<PosePrior>& prior)
    : camera_(camera), points_(std::move(points)), has_prior_(prior.has_value()) {
  if (!has_prior_) return;
  T_pose_prior_ = T0 * prior->T_camera_world.inverse();
  prior_sqrt_information_ = squareRoot(prior->information);
}

bool PoseCost::operator()(const double* increment_data, double* residuals, double* jacobian_data) const {
  const PoseIncrement increment(increment_data);
  const Eigen::Matrix3d rotation_jacobian = increment.rotationJacobian();
  Eigen::Vector3d residual;
  Jacobian3x6 jacobian;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    evaluatePoint(camera_, points_[i], increment, rotation_jacobian, &residual,
                  jacobian_data != nullptr ? &jacobian : nullptr);
    Eigen::Map<Eigen::Vector3d>(residuals + 3 * i) = residual;
    if (jacobian_data != nullptr) {
      JacobianMap(jacobian_data, NumResiduals(), 6).middleRows<3>(static_cast<Eigen::Index>(3 * i)) = jacobian;
    }
  }
  if (!has_prior_) return true;

  // Prior: the transform left over between pose and prior, translation and rotation vector.
  const Eigen::Vector3d rotated = increment.rotation() * T_pose_prior_.translation();
  Vector6d error;
  error.head<3>() = increment.apply(Eigen::Vector3d(T_pose_prior_.translation()));
  error.tail<3>() = so3Log(increment.rotation() * T_pose_prior_.linear());
  Eigen::Map<Vector6d>(residuals + 3 * points_.size()) = prior_sqrt_information_ * error;
  if (jacobian_data == nullptr) return true;
  Matrix6d error_jacobian = Matrix6d::Identity();
  error_jacobian.topRightCorner<3, 3>() = -skew(rotated) * rotation_jacobian;
  error_jacobian.bottomRightCorner<3, 3>() = so3LeftJacobianInverse(error.tail<3>()) * rotation_jacobian;
  JacobianMap(jacobian_data, NumResiduals(), 6).bottomRows<6>() = prior_sqrt_information_ * error_jacobian;
  return true;
}

}  // namespace semantic_vslam
