// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <vector>

#include "semantic_vslam/core/common/ids.h"
#include "semantic_vslam/core/common/stamp.h"
#include "semantic_vslam/core/geometry/se3.h"

namespace semantic_vslam {

/// Where the camera was at a time.
struct TimedPose {
  Stamp stamp;
  SE3 T_world_camera = SE3::Identity();
};

/// @param poses  in order of time
/// @return the pose that is closest in time, the earlier of two equally close; nullptr if none is within max_gap_s
const TimedPose* closestPose(const std::vector<TimedPose>& poses, Stamp stamp,
                             double max_gap_s = std::numeric_limits<double>::infinity());

/// Where a keyframe lies in the world.
struct KeyframePose {
  KeyframeId keyframe;
  Stamp stamp;
  SE3 T_world_camera = SE3::Identity();
};

}  // namespace semantic_vslam
