// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>

#include "semantic_vslam/core/geometry/se3.h"

namespace semantic_vslam {

/// A line of sight.
struct Ray {
  Eigen::Vector3d origin_world = Eigen::Vector3d::Zero();      ///< metres
  Eigen::Vector3d direction_world = Eigen::Vector3d::UnitZ();  ///< unit
};

/// Angle between two lines of sight, rad.
double parallax(const Ray& a, const Ray& b);

/// The point that is closest to both rays' lines, metres (the mid-point method, Hartley and Sturm 1997, section 5.2).
/// @return nothing if the rays are parallel to within rounding, or meet behind one of their origins
std::optional<Eigen::Vector3d> intersectRays(const Ray& a, const Ray& b);

/// Essential matrix of two cameras: x_b^T E x_a = 0 for rays x = (x/z, y/z, 1) (Longuet-Higgins 1981).
/// @param T_b_a  takes points of camera a to camera b, metres
Eigen::Matrix3d essentialMatrix(const SE3& T_b_a);

}  // namespace semantic_vslam
