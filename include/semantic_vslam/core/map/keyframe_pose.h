// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "semantic_vslam/core/common/ids.h"
#include "semantic_vslam/core/common/stamp.h"
#include "semantic_vslam/core/geometry/se3.h"

namespace semantic_vslam {

/// Where a keyframe lies in the world.
struct KeyframePose {
  KeyframeId keyframe;
  Stamp stamp;
  SE3 T_world_camera = SE3::Identity();
};

}  // namespace semantic_vslam
