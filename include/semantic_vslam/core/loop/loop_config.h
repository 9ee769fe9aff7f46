// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "semantic_vslam/core/optimization/optimization_config.h"

namespace semantic_vslam {

/// Finding the camera in the map without a start.
struct RelocalisationConfig {
  int max_candidates = 5;
  int neighbours = 10;
  double match_ratio = 0.8;
  double wide_radius_px = 10.0;
  double narrow_radius_px = 4.0;
  int min_inliers = 40;
  int min_cells = 10;
  double max_sigma_m = 0.02;
  double ambiguity_share = 0.7;
  double ambiguity_m = 0.3;
  PoseRansacConfig ransac;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("max_candidates", max_candidates, 1, 50, "keyframes of similar appearance that are tried");
    v.field("neighbours", neighbours, 0, 50,
            "covisible keyframes of a candidate whose landmarks are looked for as well");
    v.field("match_ratio", match_ratio, 0.5, 1.0, "Lowe's test for matches by descriptor alone");
    v.field("wide_radius_px", wide_radius_px, 1.0, 100.0, "first guided search, px at full size");
    v.field("narrow_radius_px", narrow_radius_px, 1.0, 100.0, "second guided search, with the better pose");
    v.field("min_inliers", min_inliers, 10, 1000, "landmarks that must fit in the end");
    v.field("min_cells", min_cells, 1, 48,
            "of the image's 8 x 6 cells that must hold one of them: a poster is no room");
    v.field("max_sigma_m", max_sigma_m, 0.001, 1.0, "standard deviation of the camera's position, each axis");
    v.field("ambiguity_share", ambiguity_share, 0.0, 1.0,
            "refused if another pose reaches this share of the best one's landmarks: rooms that look alike");
    v.field("ambiguity_m", ambiguity_m, 0.01, 100.0, "two poses are different ones when they are this far apart");
    v.group("ransac", ransac);
  }
};

/// What it takes to believe that the camera is back at a known place.
struct LoopDetectorConfig {
  double min_score = 0.02;
  double min_score_share = 0.5;
  int max_candidates = 20;
  int consistent_keyframes = 3;
  int confirming_neighbours = 3;
  int min_confirming_matches = 25;
  double confirming_radius_px = 5.0;
  double max_drift_share = 0.05;
  double max_drift_base_m = 0.3;
  double max_drift_rad_per_m = 0.03;
  double max_drift_base_rad = 0.15;
  double sure_share = 0.2;
  double same_place_m = 0.03;
  RelocalisationConfig verification;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("min_score", min_score, 0.0, 1.0, "share of a keyframe's features that a candidate must match");
    v.field("min_score_share", min_score_share, 0.0, 1.0,
            "a candidate must look at least this much like the keyframe as the least similar of its neighbours does");
    v.field("max_candidates", max_candidates, 1, 200, "keyframes of similar appearance that are looked at");
    v.field("consistent_keyframes", consistent_keyframes, 1, 20, "keyframes in a row that must point at one place");
    v.field(
        "confirming_neighbours", confirming_neighbours, 0, 10,
        "neighbours of the keyframe that must see the old landmarks too, where the loop would put them; where fewer "
        "should, all of these, and one at least");
    v.field("min_confirming_matches", min_confirming_matches, 5, 500, "landmarks that each of these must find");
    v.field("confirming_radius_px", confirming_radius_px, 1.0, 50.0, "search radius for these, px at full size");
    v.field("max_drift_share", max_drift_share, 0.0, 1.0,
            "drift that a loop may correct, metres for each metre travelled since the old place; RGB-D odometry drifts "
            "by 1-2 %. What asks for more is another room that looks the same");
    v.field("max_drift_base_m", max_drift_base_m, 0.0, 10.0, "added to that");
    v.field("max_drift_rad_per_m", max_drift_rad_per_m, 0.0, 1.0, "the same for rotation");
    v.field("max_drift_base_rad", max_drift_base_rad, 0.0, 3.2, "added to that");
    v.field(
        "sure_share", sure_share, 0.0, 1.0,
        "share of the landmarks that should be in view that a keyframe must find: from one on that found fewer, the "
        "map may have drifted. On pause it was 0.4 to 0.5 with a free view, 0.14 to 0.28 with people over half of it, "
        "0.1 "
        "to 0.2 with people over most of it, or with a room that stood in the map twice");
    v.field(
        "same_place_m", same_place_m, 0.0, 1.0,
        "the older map must put such a keyframe this far from where it is to be bent: a place by 40 landmarks is good "
        "to 1-2 cm (verification.max_sigma_m)");
    v.group("verification", verification);
  }
};

/// Bending the map to a closed loop.
struct LoopCorrectorConfig {
  double fuse_radius_px = 5.0;
  int neighbours = 10;
  PoseGraphConfig graph;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("fuse_radius_px", fuse_radius_px, 0.5, 50.0, "search radius for duplicates of a landmark, px at full size");
    v.field("neighbours", neighbours, 0, 50, "keyframes on either side of the loop whose landmarks are merged");
    v.group("graph", graph);
  }
};

}  // namespace semantic_vslam
