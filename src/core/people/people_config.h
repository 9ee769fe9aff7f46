// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace semantic_vslam {

/// Following of people and other movers, which the planner has to avoid and the map must not hold.
struct PeopleConfig {
  double max_depth_m = 5.0;
  double radius_m = 0.35;
  double min_area_m2 = 0.08;
  double half_depth_m = 0.12;
  double acceleration_mps2 = 2.0;
  double confirm_s = 0.2;
  double keep_s = 1.5;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("max_depth_m", max_depth_m, 0.5, 20.0,
            "farther depth is not looked at: its noise passes a tenth of a person's width");
    v.field("radius_m", radius_m, 0.1, 1.0,
            "of one mover, m: a body with swinging arms fits in; two people shoulder to shoulder are 0.5 m apart");
    v.field("min_area_m2", min_area_m2, 0.005, 1.0,
            "surface seen of it at least, m2: a third of a head and shoulders; noise at edges of depth has less");
    v.field("half_depth_m", half_depth_m, 0.0, 0.5, "from the surface that is seen to a body's axis, m");
    v.field("acceleration_mps2", acceleration_mps2, 0.1, 20.0, "standard deviation, m/s2: people stop within a step");
    v.field("confirm_s", confirm_s, 0.0, 5.0, "s that something must have been seen before it is told of");
    v.field("keep_s", keep_s, 0.0, 30.0, "s that somebody who is hidden is followed on, to be known again");
  }
};

}  // namespace semantic_vslam
