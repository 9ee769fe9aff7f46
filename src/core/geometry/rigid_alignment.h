// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "semantic_vslam/core/geometry/se3.h"

namespace semantic_vslam {

/// `target = T_target_source.linear() * (scale * source) + T_target_source.translation()`.
struct PointAlignment {
  SE3 T_target_source = SE3::Identity();
  double scale = 1.0;
  /// false if the points lie on one line (or are fewer than 3): the fit is still the best one, but its rotation about
  /// that line is arbitrary.
  bool rotation_determined = false;

  Eigen::Vector3d apply(const Eigen::Vector3d& source_m) const {
    return T_target_source.linear() * (scale * source_m) + T_target_source.translation();
  }
};

/// Least-squares alignment of two point sets, in closed form (Umeyama 1991; with scale 1 the same as Horn 1987).
/// @param source, target  metres; the i-th points belong together; same size, at least one
/// @param with_scale      also estimate the scale; else it is 1
PointAlignment alignPoints(const std::vector<Eigen::Vector3d>& source, const std::vector<Eigen::Vector3d>& target,
                           bool with_scale = false);

}  // namespace semantic_vslam
