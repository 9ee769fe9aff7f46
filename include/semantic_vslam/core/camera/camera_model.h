// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <opencv2/core.hpp>
#include <string>

namespace semantic_vslam {

/// Intrinsics of a pinhole camera, in the terms of sensor_msgs/CameraInfo with the plumb_bob model.
struct CameraIntrinsics {
  int width = 640;                                        ///< px
  int height = 480;                                       ///< px
  double fx = 525.0, fy = 525.0, cx = 319.5, cy = 239.5;  ///< px
  std::array<double, 5> distortion{};                     ///< k1 k2 p1 p2 k3; all 0 for a rectified image
};

/// The plumb_bob model: moves a ray (x, y, 1) to where the lens shows it. @param k  k1 k2 p1 p2 k3
template <class Scalar>
void distortPlumbBob(const std::array<Scalar, 5>& k, Scalar& x, Scalar& y) {
  const Scalar r2 = x * x + y * y;
  const Scalar radial = 1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
  const Scalar moved_x = x * radial + 2 * k[2] * x * y + k[3] * (r2 + 2 * x * x);
  y = y * radial + k[2] * (r2 + 2 * y * y) + 2 * k[3] * x * y;
  x = moved_x;
}

/// Pinhole camera with plumb_bob distortion. Immutable, so that frames and threads share one.
///
/// Two kinds of pixel: a *raw* pixel is where the image shows a point; an *undistorted* pixel is where an ideal pinhole
/// camera of the same fx, fy, cx, cy would show it. Images, masks and depth are raw; features carry both.
/// Points are in the optical frame: x right, y down, z forward, metres.
class CameraModel {
 public:
  /// @throws ConfigError if a size or focal length is not positive or a value is not finite.
  explicit CameraModel(const CameraIntrinsics& intrinsics);

  const CameraIntrinsics& intrinsics() const { return intrinsics_; }
  int width() const { return intrinsics_.width; }
  int height() const { return intrinsics_.height; }
  double fx() const { return intrinsics_.fx; }
  double fy() const { return intrinsics_.fy; }
  double cx() const { return intrinsics_.cx; }
  double cy() const { return intrinsics_.cy; }

  /// Ideal projection. @param point_camera metres, z > 0. @return undistorted pixel.
  Eigen::Vector2d projectUndistorted(const Eigen::Vector3d& point_camera) const;
  /// Projection into the image as recorded. @param point_camera metres, z > 0. @return raw pixel.
  Eigen::Vector2d projectRaw(const Eigen::Vector3d& point_camera) const;
  /// @param undistorted_px undistorted pixel  @param depth_m z in metres  @return point in metres.
  Eigen::Vector3d unprojectUndistorted(const Eigen::Vector2d& undistorted_px, double depth_m) const;
  /// x/z and y/z of every raw pixel: height x width, 2 x float32. Multiply by depth in metres for the point.
  const cv::Mat2f& rays() const { return rays_; }
  /// Sub-pixel raw position to undistorted position.
  Eigen::Vector2d undistort(const Eigen::Vector2d& raw_px) const;

  bool contains(const Eigen::Vector2d& px, double border_px = 0.0) const {
    return px.x() >= border_px && px.y() >= border_px && px.x() < width() - border_px && px.y() < height() - border_px;
  }

 private:
  CameraIntrinsics intrinsics_;
  bool distorted_ = false;
  cv::Mat2f rays_;
};

/// Reads `cfg/cameras/*.yaml`: width, height, fx, fy, cx, cy, distortion: [k1, k2, p1, p2, k3].
/// @throws FileError or ConfigError naming the file and the key.
CameraIntrinsics loadCameraFile(const std::string& path);

}  // namespace semantic_vslam
