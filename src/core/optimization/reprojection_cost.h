// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "core/camera/observation_model.h"
#include "core/optimization/huber.h"
#include "core/optimization/pose_increment.h"
#include "semantic_vslam/core/geometry/se3.h"

namespace semantic_vslam {

/// Whitened reprojection error of one landmark in one keyframe, by the increment of the keyframe's pose (PoseIncrement)
/// and the landmark's position. The kernel is not part of it.
/// @tparam kResiduals  3: pixel and depth; 2: pixel alone
template <int kResiduals>
struct ReprojectionCost {
  static_assert(kResiduals == 2 || kResiduals == 3, "pixel, or pixel and depth");
  VirtualStereo camera;
  SE3 T0_camera_world;  ///< pose around which increments are taken
  PixelMeasurement measurement;

  /// @param increment  6 values   @param point_world  3 values, metres   @param residuals  kResiduals values
  /// @param by_increment, by_point  row-major kResiduals x 6 and kResiduals x 3, or nullptr
  /// A point that comes too near the image plane has no residual.
  void evaluate(const double* increment, const double* point_world, double* residuals, double* by_increment,
                double* by_point) const {
    using PoseJacobian = Eigen::Matrix<double, kResiduals, 6, Eigen::RowMajor>;
    using PointJacobian = Eigen::Matrix<double, kResiduals, 3, Eigen::RowMajor>;
    Eigen::Map<Eigen::Matrix<double, kResiduals, 1>> error(residuals);

    const PoseIncrement pose(increment);
    const Eigen::Vector3d at_T0 = T0_camera_world * Eigen::Map<const Eigen::Vector3d>(point_world);
    const Eigen::Vector3d p = pose.apply(at_T0);
    if (p.z() < kMinProjectionDepthM) {
      error.setZero();
      if (by_increment != nullptr) Eigen::Map<PoseJacobian>(by_increment).setZero();
      if (by_point != nullptr) Eigen::Map<PointJacobian>(by_point).setZero();
      return;
    }
    error = whitenedError(camera, measurement, p).template head<kResiduals>();
    if (by_increment == nullptr && by_point == nullptr) return;
    const Eigen::Matrix<double, kResiduals, 3> by_p =
        whitenedErrorJacobian(camera, measurement, p).template topRows<kResiduals>();
    if (by_increment != nullptr) {
      Eigen::Map<PoseJacobian> j(by_increment);
      j.template leftCols<3>() = by_p;
      j.template rightCols<3>() = -by_p * skew(pose.rotation() * at_T0) * pose.rotationJacobian();
    }
    if (by_point != nullptr) {
      Eigen::Map<PointJacobian> j(by_point);
      j = by_p * pose.rotation() * T0_camera_world.linear();
    }
  }
};

}  // namespace semantic_vslam
