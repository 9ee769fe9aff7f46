// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/dense/keyframe_cloud.h"

namespace semantic_vslam {

/// The direction against gravity, in the world: the normal of the plane that holds most points among those within 50
/// degrees of prior_up (a floor or a desk). Seeded RANSAC: the same cloud gives the same answer.
/// @param prior_up  e.g. (0, -1, 0), up in the first camera's optical frame, which is roughly level
/// @return unit vector; prior_up where no plane holds a twentieth of the points
Eigen::Vector3d estimateUpDirection(const std::vector<LabelledPoint>& cloud, const Eigen::Vector3d& prior_up);

}  // namespace semantic_vslam
