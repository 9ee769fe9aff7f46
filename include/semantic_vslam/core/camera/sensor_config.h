// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace semantic_vslam {

/// The depth sensor as tracking, mapping and the optimisers see it: a virtual stereo camera (Mur-Artal and Tardos 2017,
/// section III.A). One for all stages, since they must agree on which points are close.
struct SensorConfig {
  double virtual_baseline_m = 0.08;
  double depth_sigma_at_1m_m = 0.016;
  double close_baselines = 40.0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("virtual_baseline_m", virtual_baseline_m, 0.01, 1.0,
            "baseline of the virtual stereo camera that depth is compared in; 0.08 m is a Kinect's");
    v.field("depth_sigma_at_1m_m", depth_sigma_at_1m_m, 0.0001, 1.0,
            "standard deviation of a feature's depth at 1 m, metres; it grows with the square of the distance. 1.6 cm "
            "covers a Kinect's registration and edge errors, since features lie on edges; motion.rigid has that of "
            "surfaces");
    v.field("close_baselines", close_baselines, 1.0, 1000.0,
            "a point is close up to this many virtual baselines (40 x 0.08 m = 3.2 m): its depth alone makes a "
            "landmark and is used by the optimisers; farther off its error exceeds its worth");
  }

  /// Depth up to which a point is close, metres.
  double closeM() const { return close_baselines * virtual_baseline_m; }
};

}  // namespace semantic_vslam
