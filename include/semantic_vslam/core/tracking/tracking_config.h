// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "semantic_vslam/core/features/features_config.h"
#include "semantic_vslam/core/optimization/optimization_config.h"

namespace semantic_vslam {

/// Finding the last frame's points again.
struct FrameTrackerConfig : FramePoseConfig {
  double search_radius_px = 15.0;
  int minimum_matches = 20;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("search_radius_px", search_radius_px, 2.0, 100.0,
            "how far from its predicted place a point of the last frame is looked for, px at full size");
    v.field("minimum_matches", minimum_matches, 6, 500,
            "with fewer matches than this the search is tried again with twice the radius, then fails");
    v.group("pose", pose);
  }
};

/// What the first two frames of a map must hold.
struct InitializerConfig {
  int min_points = 200;
  int min_inliers = 80;
  double min_inlier_share = 0.5;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("min_points", min_points, 20, 5000, "static features with depth that the first frame k1 must have");
    v.field("min_inliers", min_inliers, 10, 5000, "matches between k1 and k2 that must agree on one rigid motion");
    v.field("min_inlier_share", min_inlier_share, 0.1, 1.0, "share of the matches that must agree");
  }
};

/// The part of the map that is looked for in a frame.
struct LocalMapConfig {
  int max_keyframes = 60;
  int neighbours = 10;
  double search_radius_px = 3.0;
  double wide_radius_px = 8.0;
  double min_view_cosine = 0.5;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("max_keyframes", max_keyframes, 5, 500, "keyframes whose landmarks are looked for in a frame");
    v.field("neighbours", neighbours, 0, 50, "covisible neighbours taken in of each keyframe that the frame matches");
    v.field("search_radius_px", search_radius_px, 1.0, 30.0,
            "search radius round a projected landmark, px at full size, seen along its usual direction");
    v.field("wide_radius_px", wide_radius_px, 1.0, 60.0, "the same seen obliquely (over 3.6 degrees off)");
    v.field("min_view_cosine", min_view_cosine, 0.0, 1.0,
            "landmarks seen further off their usual direction than this cosine (0.5: 60 degrees) are not looked for");
  }
};

/// When a frame becomes a keyframe.
struct KeyframePolicyConfig {
  int max_gap_frames = 30;
  int min_gap_frames = 3;
  double min_view_share = 0.7;
  int min_close_tracked = 100;
  int min_close_new = 70;
  int min_tracked = 100;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("max_gap_frames", max_gap_frames, 1, 1000,
            "frames after which a keyframe is due in any case (1 s at 30 Hz)");
    v.field("min_gap_frames", min_gap_frames, 0, 100, "frames that lie between keyframes while tracking is not weak");
    v.field(
        "min_view_share", min_view_share, 0.1, 1.0,
        "a keyframe is due when less than this share is tracked of the most landmarks that one frame since the last "
        "keyframe has tracked: the rest of the view is new. Counting the last keyframe's confirmed landmarks "
        "instead, as ORB-SLAM2 does, starves where keyframes are sparse: few confirm each other then");
    v.field("min_close_tracked", min_close_tracked, 0, 1000,
            "fewer tracked close points than this, with min_close_new new ones at hand, need a keyframe at once");
    v.field("min_close_new", min_close_new, 0, 1000, "see min_close_tracked");
    v.field(
        "min_tracked", min_tracked, 0, 1000,
        "fewer tracked landmarks than this, with min_close_new features at hand that have depth but no landmark, need "
        "a keyframe too, however far they are: through a doorway there may be nothing close");
  }
};

/// Tracking: group `tracking` of SystemConfig.
struct TrackerConfig {
  int min_inliers = 30;
  double recently_lost_s = 1.0;
  double new_map_after_s = 5.0;
  OrbConfig orb;
  InitializerConfig initializer;
  FrameTrackerConfig frame;
  LocalMapConfig local_map;
  KeyframePolicyConfig keyframe;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("min_inliers", min_inliers, 10, 500, "landmarks of the map that must fit for a frame to count as tracked");
    v.field("recently_lost_s", recently_lost_s, 0.0, 10.0,
            "how long the motion model alone carries the pose before the state is LOST; a hand-held camera keeps its "
            "velocity for about a second at best");
    v.field("new_map_after_s", new_map_after_s, 0.0, 1e6,
            "after this long without finding its place the camera begins a new map, which is joined with the old one "
            "when a known place is seen again; covered lenses and passers-by are mostly gone by then. A map that took "
            "less time to make is waited for no longer than that, but 1 s");
    v.group("orb", orb);
    v.group("initializer", initializer);
    v.group("frame", frame);
    v.group("local_map", local_map);
    v.group("keyframe", keyframe);
  }
};

}  // namespace semantic_vslam
