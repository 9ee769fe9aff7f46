// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace semantic_vslam {

/// The depth sensor as tracking, mapping and the optimisers see it: a virtual stereo camera (Mur-Artal and Tardos 2017,
/// section III.A). One for all stages, since they must agree on which points are close.
struct SensorConfig {
  double virtual_baseline_m = 0.08;
  double depth_sigma_px = 1.0;
  double close_baselines = 40.0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("virtual_baseline_m", virtual_baseline_m, 0.01, 1.0,
            "baseline of the virtual stereo camera that depth is compared in; 0.08 m is a Kinect's");
    v.field("depth_sigma_px", depth_sigma_px, 0.01, 100.0,
            "standard deviation of measured depth, px of disparity at the virtual baseline: z^2 / (fx b) metres a px; "
            "1 px is 2.4 cm at 1 m, which covers a Kinect's registration and edge errors where features lie");
    v.field("close_baselines", close_baselines, 1.0, 1000.0,
            "a point is close up to this many virtual baselines (40 x 0.08 m = 3.2 m): its depth alone makes a "
            "landmark and is used by the optimisers; farther off its error exceeds its worth");
  }

  /// Depth up to which a point is close, metres.
  double closeM() const { return close_baselines * virtual_baseline_m; }
};

}  // namespace semantic_vslam
