// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace semantic_vslam {

/// How many ORB features a frame gets, and where.
struct OrbConfig {
  int features = 1000;
  int fast_threshold = 30;  // FAST takes as long as there are corners; at 20 five in six are thrown away again
  int fast_threshold_low = 7;
  int cell_px = 32;
  int minimum_static = 200;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("features", features, 100, 5000, "features kept per frame; 1000 is the ORB-SLAM2 setting for 640x480");
    v.field("fast_threshold", fast_threshold, 5, 100, "grey levels a FAST corner must differ by");
    v.field("fast_threshold_low", fast_threshold_low, 2, 100, "the same in cells where the first finds nothing");
    v.field("cell_px", cell_px, 16, 128, "side of a detection cell in px of its pyramid level");
    v.field("minimum_static", minimum_static, 0, 2000,
            "with fewer features outside the dynamic mask, the least dynamic ones inside it are kept with low weight");
  }
};

/// The index that finds keyframes by appearance.
struct PlaceIndexConfig {
  int max_features = 500;
  int leaf_size = 64;
  int trees = 2;
  int max_distance = 40;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("max_features", max_features, 50, 5000,
            "features of a keyframe that are kept, evenly drawn; 40 bytes each and tree: 40 MB for 1000 keyframes");
    v.field("leaf_size", leaf_size, 16, 1024, "descriptors in a leaf before it is split");
    v.field("trees", trees, 1, 8,
            "trees, each splitting on bits of its own: a pair of sightings is missed only where all do");
    v.field("max_distance", max_distance, 8, 100, "two descriptors that differ in at most this many of 256 bits match");
  }
};

}  // namespace semantic_vslam
