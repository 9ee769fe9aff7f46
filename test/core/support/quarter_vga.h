// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "semantic_vslam/core/camera/camera_model.h"

namespace semantic_vslam {

/// A Kinect's view at a quarter of its pixels, so that rendered tests are quick.
inline CameraIntrinsics quarterVga() { return {320, 240, 262.5, 262.5, 159.5, 119.5, {}}; }

}  // namespace semantic_vslam
