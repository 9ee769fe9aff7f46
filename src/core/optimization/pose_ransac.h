// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "core/optimization/pose_optimizer.h"
#include "semantic_vslam/core/optimization/optimization_config.h"

namespace semantic_vslam {

/// Pose of a camera from matches of which many may be wrong, without a start: samples of three matches, each solved by
/// P3P, the pose that most matches fit (RANSAC, Fischler and Bolles 1981). The samples depend on nothing but the number
/// of matches, so the same problem gives the same pose.
/// @param problem  T_camera_world is not used
/// @return the pose of the best sample, to be optimised by the caller; nothing if fewer than min_inliers fit.
std::optional<SE3> findPose(const PoseProblem& problem, const PoseRansacConfig& config);

}  // namespace semantic_vslam
