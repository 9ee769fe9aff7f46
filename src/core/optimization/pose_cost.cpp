// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/optimization/pose_cost.h"

#include <cmath>

#include "core/optimization/huber.h"

namespace semantic_vslam {
namespace {

using JacobianMap = Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, 6>>;

}  // namespace

PoseCost::PoseCost(const VirtualStereo& camera, const std::vector<Point>& points) {
  terms_.reserve(points.size());
  for (const Point& point : points) terms_.emplace_back(camera, point);
}

PoseCost::Term::Term(const VirtualStereo& camera, const Point& point)
    : point_camera(point.point_camera),
      chi2_bound(point.measurement.chi2Bound()),
      root_weight(std::sqrt(point.measurement.weight)) {
  const PixelMeasurement& m = point.measurement;
  const double per_px = 1.0 / m.sigma_px, per_disparity_px = m.hasDepth() ? 1.0 / m.disparity_sigma_px : 0.0;
  measured = {(m.undistorted_px.x() - camera.cx) * per_px, (m.undistorted_px.y() - camera.cy) * per_px,
              m.disparity_px * per_disparity_px};
  focal = {camera.fx * per_px, camera.fy * per_px, camera.fx_baseline * per_disparity_px};
}

void PoseCost::Term::evaluate(const PoseIncrement& increment, const Eigen::Matrix3d& rotation_jacobian,
                              Eigen::Vector3d* residual, Eigen::Matrix<double, 3, 6>* jacobian) const {
  const Eigen::Vector3d rotated = increment.rotation() * point_camera;
  const Eigen::Vector3d p = rotated + increment.translation();
  if (p.z() < kMinProjectionDepthM) {
    residual->setZero();
    if (jacobian != nullptr) jacobian->setZero();
    return;
  }
  const double inverse_z = 1.0 / p.z();
  const Eigen::Vector3d ray(p.x() * inverse_z, p.y() * inverse_z, inverse_z);
  const Eigen::Vector3d error = measured - focal.cwiseProduct(ray);
  double scale_derivative = 0.0;
  const double scale = root_weight * huberScale(error.squaredNorm(), chi2_bound, &scale_derivative);
  *residual = scale * error;
  if (jacobian == nullptr) return;

  const Eigen::Vector3d gain = -inverse_z * focal;
  auto by_point = jacobian->leftCols<3>();
  by_point << gain.x(), 0, -gain.x() * ray.x(), 0, gain.y(), -gain.y() * ray.y(), 0, 0, -gain.z() * inverse_z;
  // g * -skew(rotated) = (rotated x g)^T, row by row
  for (int row = 0; row < 3; ++row) {
    jacobian->row(row).tail<3>() = rotated.cross(by_point.row(row).transpose()).transpose() * rotation_jacobian;
  }
  if (scale_derivative == 0.0) {
    *jacobian *= scale;
  } else {
    const Eigen::Matrix<double, 1, 6> along_error = error.transpose() * *jacobian;
    *jacobian = scale * *jacobian + (root_weight * 2.0 * scale_derivative) * error * along_error;
  }
}

bool PoseCost::operator()(const double* increment_data, double* residuals, double* jacobian_data) const {
  const PoseIncrement increment(increment_data);
  const Eigen::Matrix3d rotation_jacobian = increment.rotationJacobian();
  Eigen::Vector3d residual;
  Eigen::Matrix<double, 3, 6> jacobian;
  for (std::size_t i = 0; i < terms_.size(); ++i) {
    terms_[i].evaluate(increment, rotation_jacobian, &residual, jacobian_data != nullptr ? &jacobian : nullptr);
    Eigen::Map<Eigen::Vector3d>(residuals + 3 * i) = residual;
    if (jacobian_data != nullptr) {
      JacobianMap(jacobian_data, NumResiduals(), 6).middleRows<3>(static_cast<Eigen::Index>(3 * i)) = jacobian;
    }
  }
  return true;
}

}  // namespace semantic_vslam
