// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/dense/keyframe_cloud.h"

namespace semantic_vslam {

/// The direction against gravity, in the world: the normal of the plane that holds most points among those within 50
/// degrees of prior_up (a floor or a desk). Seeded RANSAC: the same cloud gives the same answer.
/// @param prior_up  e.g. (0, -1, 0), up in the first camera's optical frame, which is roughly level
/// @return unit vector; prior_up where no plane holds a twentieth of the points
Eigen::Vector3d estimateUpDirection(const std::vector<LabelledPoint>& cloud, const Eigen::Vector3d& prior_up);

/// The floor as a plane: up.dot(p) - offset_m is a point's height above it.
struct Floor {
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  ///< unit vector
  double offset_m = 0.0;

  double heightOf(const Eigen::Vector3d& point) const { return up.dot(point) - offset_m; }
  double tiltDeg() const;  ///< against +z
};

/// The largest level plane that next to nothing lies below. Seeded RANSAC.
/// @param surface  centres of the map's occupied voxels, in a frame whose z is up within 20 degrees
/// @param voxel_m  their edge
/// @return nothing where no such plane of 0.5 m^2 was seen
std::optional<Floor> findFloor(const std::vector<Eigen::Vector3d>& surface, double voxel_m);

}  // namespace semantic_vslam
