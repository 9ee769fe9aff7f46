// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "semantic_vslam/core/motion/motion_result.h"
#include "semantic_vslam/core/pipeline/tracking_stage.h"

namespace semantic_vslam {

/// What the whole way made of one frame.
struct StepResult : TrackingOutput {
  MotionResult motion;
  /// A keyframe that was mapped in this step, and what was removed from it.
  struct Mapped {
    Stamp stamp;
    cv::Mat1b removed;
  };
  std::vector<Mapped> mapped;  ///< by Pipeline only: elsewhere it comes later

  SE3 T_world_camera() const { return tracking.T_camera_world.inverse(); }  ///< a prediction while RECENTLY_LOST
};

}  // namespace semantic_vslam
