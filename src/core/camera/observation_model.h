// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "semantic_vslam/core/camera/camera_model.h"
#include "semantic_vslam/core/camera/sensor_config.h"

/// How a point appears to an RGB-D camera, and how far off a measurement of it may be.
namespace semantic_vslam {

/// The closest a point may come to the image plane, metres.
constexpr double kMinProjectionDepthM = 0.05;
/// Chi-square bounds that hold 95 % of the true matches, 2 and 3 degrees of freedom.
constexpr double kChi2Pixel = 5.991;
constexpr double kChi2PixelAndDepth = 7.815;

/// One measured feature as the optimisers use it. Depth z enters as the disparity fx * b / z of a virtual stereo pair
/// (ORB-SLAM2, section III.A: u_R = u - fx * b / z). The disparity itself is the third coordinate here instead of u_R:
/// its noise is independent of the noise of u, so the information matrix stays diagonal.
struct PixelMeasurement {
  Eigen::Vector2d undistorted_px = Eigen::Vector2d::Zero();
  double disparity_px = 0.0;        ///< fx * virtual_baseline_m / depth_m; 0 = no depth
  double sigma_px = 1.0;            ///< of undistorted_px, each axis
  double disparity_sigma_px = 1.0;  ///< of disparity_px
  double weight = 1.0;              ///< scales the information; 0 = no influence

  bool hasDepth() const { return disparity_px > 0.0; }
  double chi2Bound() const { return hasDepth() ? kChi2PixelAndDepth : kChi2Pixel; }
};

/// Pinhole camera with a virtual second one at `virtual_baseline_m` to its right.
struct VirtualStereo {
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;  ///< px
  double fx_baseline = 0.0;                       ///< fx * virtual_baseline_m, px * m

  VirtualStereo() = default;
  VirtualStereo(const CameraIntrinsics& k, double virtual_baseline_m)
      : fx(k.fx), fy(k.fy), cx(k.cx), cy(k.cy), fx_baseline(k.fx * virtual_baseline_m) {}

  /// @param p metres, z > 0. @return (u, v, disparity), px.
  Eigen::Vector3d project(const Eigen::Vector3d& p) const {
    const double inverse_z = 1.0 / p.z();
    return {fx * p.x() * inverse_z + cx, fy * p.y() * inverse_z + cy, fx_baseline * inverse_z};
  }
  /// Derivative of project(): 3x3, px per metre.
  Eigen::Matrix3d projectJacobian(const Eigen::Vector3d& p) const {
    const double inverse_z = 1.0 / p.z(), inverse_z2 = inverse_z * inverse_z;
    Eigen::Matrix3d j;
    j << fx * inverse_z, 0, -fx * p.x() * inverse_z2, 0, fy * inverse_z, -fy * p.y() * inverse_z2, 0, 0,
        -fx_baseline * inverse_z2;
    return j;
  }
};

/// Whitened error (measured - predicted) / sigma of (u, v, disparity); the third is 0 where there is no depth.
inline Eigen::Vector3d whitenedError(const VirtualStereo& camera, const PixelMeasurement& m,
                                     const Eigen::Vector3d& point_camera) {
  const Eigen::Vector3d predicted = camera.project(point_camera);
  return {(m.undistorted_px.x() - predicted.x()) / m.sigma_px, (m.undistorted_px.y() - predicted.y()) / m.sigma_px,
          m.hasDepth() ? (m.disparity_px - predicted.z()) / m.disparity_sigma_px : 0.0};
}

/// Whether a point can be what was measured: in front of the camera, and its error one that 95 % of the true have.
inline bool fits(const VirtualStereo& camera, const PixelMeasurement& m, const Eigen::Vector3d& point_camera) {
  return point_camera.z() >= kMinProjectionDepthM &&
         whitenedError(camera, m, point_camera).squaredNorm() <= m.chi2Bound();
}

/// Derivative of whitenedError() by the point in the camera frame, 3x3.
inline Eigen::Matrix3d whitenedErrorJacobian(const VirtualStereo& camera, const PixelMeasurement& m,
                                             const Eigen::Vector3d& point_camera) {
  Eigen::Matrix3d j = -camera.projectJacobian(point_camera);
  j.topRows<2>() /= m.sigma_px;
  j.row(2) *= m.hasDepth() ? 1.0 / m.disparity_sigma_px : 0.0;
  return j;
}

/// The measurement that the optimisers see of a feature. @param depth_m 0 = none
PixelMeasurement makeMeasurement(const Eigen::Vector2d& undistorted_px, double depth_m, double sigma_px, double weight,
                                 const VirtualStereo& camera, const SensorConfig& sensor);

}  // namespace semantic_vslam
