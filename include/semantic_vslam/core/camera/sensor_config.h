// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace semantic_vslam {

// The noise of depth: its standard deviation at 1 m, metres, which grows with the square of the distance (structured
// light and stereo alike). One group of keys, depth_noise, for all stages; what each looks at is differently noisy.

/// Of a feature's depth.
struct FeatureDepthNoise {
  double features_m = 0.016;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("features_m", features_m, 0.0001, 1.0,
            "of a feature's depth, for tracking and the optimisers, at 1 m, metres; 1.6 cm covers a Kinect's "
            "registration and edge errors, since features lie on edges");
  }
};

/// Of two frames' depth of one cell, which the motion stage compares.
struct MotionDepthNoise {
  double motion_m = 0.003;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("motion_m", motion_m, 0.0002, 0.05,
            "of what the motion stage compares, surfaces between their edges, at 1 m, metres");
  }
};

/// Of a surface's points in the dense map.
struct MapDepthNoise {
  double surfaces_m = 0.0019;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("surfaces_m", surfaces_m, 0.0001, 0.1,
            "of the dense map's points, at 1 m, metres; 0.0019 for Kinect v1 (Nguyen et al. 2012)");
  }
};

/// The depth sensor as tracking, mapping and the optimisers see it: a virtual stereo camera (Mur-Artal and Tardos 2017,
/// section III.A). One for all stages, since they must agree on which points are close.
struct SensorConfig {
  double virtual_baseline_m = 0.08;
  FeatureDepthNoise depth_noise;
  double close_baselines = 40.0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("virtual_baseline_m", virtual_baseline_m, 0.01, 1.0,
            "baseline of the virtual stereo camera that depth is compared in; 0.08 m is a Kinect's");
    v.field("close_baselines", close_baselines, 1.0, 1000.0,
            "a point is close up to this many virtual baselines (40 x 0.08 m = 3.2 m): its depth alone makes a "
            "landmark and is used by the optimisers; farther off its error exceeds its worth");
  }

  /// Depth up to which a point is close, metres.
  double closeM() const { return close_baselines * virtual_baseline_m; }
};

}  // namespace semantic_vslam
