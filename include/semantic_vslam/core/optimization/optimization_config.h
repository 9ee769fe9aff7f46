// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "semantic_vslam/core/camera/sensor_config.h"

namespace semantic_vslam {

/// Pose of one camera from matches with fixed points.
struct PoseOptimizerConfig {
  int rounds = 4;
  int iterations = 10;
  int min_inliers = 10;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("rounds", rounds, 1, 10, "rounds of optimisation, each followed by a new look at who is an inlier");
    v.field("iterations", iterations, 1, 100, "most solver steps in a round");
    v.field("min_inliers", min_inliers, 4, 1000, "fewer inliers leave the pose unusable");
  }
};

/// What refining a frame's pose takes, whoever asks for it: tracking, relocalisation or loop detection.
struct FramePoseConfig {
  SensorConfig sensor;  ///< of all stages; a group of keys of its own beside `tracking` (SparseSlamConfig)
  PoseOptimizerConfig pose;

  template <class Visitor>
  void visit(Visitor& v) {
    v.group("pose", pose);
  }
};

/// Pose of one camera without a start, from matches of which many may be wrong.
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

/// Bundle adjustment: keyframes and landmarks together.
struct BaConfig {
  int max_keyframes = 15;
  int max_fixed_keyframes = 20;
  int min_shared = 15;
  int first_iterations = 5;
  int second_iterations = 10;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("max_keyframes", max_keyframes, 1, 1000,
            "keyframes whose pose a local adjustment changes, the centre included");
    v.field("max_fixed_keyframes", max_fixed_keyframes, 1, 1000,
            "keyframes around them that hold a local adjustment in place, those that see most of its landmarks");
    v.field("min_shared", min_shared, 1, 1000, "landmarks that a keyframe must share with the centre to be adjusted");
    v.field("first_iterations", first_iterations, 1, 100, "most steps before wrong matches are taken out");
    v.field("second_iterations", second_iterations, 1, 100, "most steps after it");
  }
};

/// The graph of keyframe poses that a closed loop bends.
struct PoseGraphConfig {
  int min_shared = 100;
  int iterations = 50;
  double translation_sigma_m = 0.01;
  double rotation_sigma_rad = 0.005;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("min_shared", min_shared, 15, 1000,
            "landmarks that two keyframes must share for an edge of the essential graph");
    v.field("iterations", iterations, 1, 1000, "most solver steps");
    v.field("translation_sigma_m", translation_sigma_m, 1e-4, 1.0,
            "error of one edge's translation; only its ratio to the rotation's matters: 1 cm to 0.3 degrees, what "
            "visual odometry drifts by between two keyframes at room scale");
    v.field("rotation_sigma_rad", rotation_sigma_rad, 1e-4, 1.0, "error of one edge's rotation");
  }
};

}  // namespace semantic_vslam
