// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace semantic_vslam {

/// Which landmarks and keyframes the sparse map gets and keeps.
struct MapMaintenanceConfig {
  int min_new_points = 100;
  double min_found_share = 0.25;
  int probation_keyframes = 3;
  double redundant_share = 0.85;
  double fuse_radius_px = 3.0;
  int fuse_neighbours = 10;
  int min_tree_keyframes = 5;
  double min_tree_s = 1.0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("min_new_points", min_new_points, 0, 1000,
            "where fewer close points are at hand, the nearest points are taken up to this number");
    v.field(
        "min_found_share", min_found_share, 0.0, 1.0,
        "a landmark on probation is dropped if it is found in less than this share of the frames that should see it");
    v.field("probation_keyframes", probation_keyframes, 1, 20,
            "keyframes within which a new landmark must be seen by a second one");
    v.field(
        "redundant_share", redundant_share, 0.5, 1.0,
        "a keyframe is dropped when this share of its close landmarks is seen by 3 others, as large or larger; 0.85 "
        "instead of ORB-SLAM2's 0.9 keeps a map of one place from growing: 5 % in ten passes");
    v.field("fuse_radius_px", fuse_radius_px, 0.5, 20.0, "search radius for duplicates of a landmark, px at full size");
    v.field("fuse_neighbours", fuse_neighbours, 1, 50,
            "covisible keyframes whose landmarks are merged with a new one's");
    v.field("min_tree_keyframes", min_tree_keyframes, 1, 100,
            "a new map that is lost again before it has this many and was never joined is dropped: it shows a second "
            "or two of the way, and loop closing wants three in a row that point at one place and neighbours of theirs "
            "to confirm it");
    v.field("min_tree_s", min_tree_s, 0.0, 60.0,
            "so is one whose keyframes lie within this many s: where tracking is weak, as among people, keyframes come "
            "every third frame, and five of them show one view");
  }
};

/// Landmarks of points whose depth is missing or too uncertain: from two views.
struct TriangulationConfig {
  int neighbours = 10;
  double min_parallax_deg = 1.0;
  double match_ratio = 0.8;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("neighbours", neighbours, 0, 50,
            "covisible keyframes that a new keyframe's points without usable depth are triangulated with; 0 = none");
    v.field("min_parallax_deg", min_parallax_deg, 0.1, 30.0,
            "least angle between the two views: at 1 degree a pixel's error is a tenth of the distance");
    v.field("match_ratio", match_ratio, 0.5, 1.0,
            "Lowe's test among the features along the epipolar line: their place says little by itself");
  }
};

}  // namespace semantic_vslam
