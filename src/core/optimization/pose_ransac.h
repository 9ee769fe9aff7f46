// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "core/optimization/pose_optimizer.h"

namespace semantic_vslam {

struct PoseRansacConfig {
  int iterations = 200;
  double tolerance = 2.0;
  int min_inliers = 12;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("iterations", iterations, 10, 100000, "most samples; fewer are drawn once they are enough for 99.9 %");
    v.field("tolerance", tolerance, 1.0, 10.0,
            "a match fits a sample's pose within this many times the error of an optimised one");
    v.field("min_inliers", min_inliers, 6, 1000, "fewer matches that fit are no pose");
  }
};

/// Pose of a camera from matches of which many may be wrong, without a start: samples of three matches, each solved by
/// P3P, the pose that most matches fit (RANSAC, Fischler and Bolles 1981). The samples depend on nothing but the number
/// of matches, so the same problem gives the same pose.
/// @param problem  T_camera_world and prior are not used
/// @return the pose of the best sample, to be optimised by the caller; nothing if fewer than min_inliers fit.
std::optional<SE3> findPose(const PoseProblem& problem, const PoseRansacConfig& config);

}  // namespace semantic_vslam
