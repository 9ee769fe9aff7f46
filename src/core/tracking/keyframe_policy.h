// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/map/map.h"
#include "core/map/tracked_frame.h"
#include "semantic_vslam/core/common/ids.h"
#include "semantic_vslam/core/tracking/tracking_config.h"

namespace semantic_vslam {

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
