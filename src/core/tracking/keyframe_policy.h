// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/map/map.h"
#include "core/map/tracked_frame.h"
#include "semantic_vslam/core/common/ids.h"

namespace semantic_vslam {

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

/// What the policy looks at, counted once per frame.
struct KeyframeEvidence {
  int frames_since_keyframe = 0;
  int tracked = 0;        ///< inlier landmarks of the frame
  int most_tracked = 0;   ///< the most of any frame since the last keyframe, this one included
  int close_tracked = 0;  ///< close static features with a landmark
  int close_new = 0;      ///< close static features without
  int all_new = 0;        ///< static features with depth and without a landmark, at any distance
  bool mapper_idle = true;
};

/// After ORB-SLAM2's conditions for RGB-D (Mur-Artal and Tardos 2017, section III.E).
bool keyframeIsDue(const KeyframeEvidence& evidence, const KeyframePolicyConfig& config);

/// Counts the frame's static features with depth. @param close_m  metres
void countClose(const TrackedFrame& frame, double close_m, KeyframeEvidence& evidence);

}  // namespace semantic_vslam
