// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "semantic_vslam/core/common/ids.h"
#include "semantic_vslam/core/common/stamp.h"
#include "semantic_vslam/core/geometry/se3.h"

namespace semantic_vslam {

/// One coloured, labelled point. In the camera frame in a KeyframeCloud, in the world elsewhere.
struct LabelledPoint {
  cv::Vec3f xyz_m;
  cv::Vec3b bgr;
  std::uint8_t label = 0;
};

/// What one keyframe adds to the dense map: its static, labelled surface in its own camera frame, so that a loop can
/// move it without computing it again.
struct KeyframeCloud {
  KeyframeId keyframe;
  Stamp stamp;
  std::vector<LabelledPoint> points;
};

struct KeyframePose {
  KeyframeId keyframe;
  Stamp stamp;
  SE3 T_world_camera = SE3::Identity();
};

}  // namespace semantic_vslam
