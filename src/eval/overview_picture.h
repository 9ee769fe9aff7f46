// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/dense/keyframe_cloud.h"
#include "eval/trajectory_error.h"
#include "semantic_vslam/core/camera/camera_model.h"
#include "semantic_vslam/core/common/label_set.h"

namespace semantic_vslam {

/// What the overview of a run shows.
struct OverviewContent {
  std::string title, subtitle;
  std::vector<LabelledPoint> cloud;  ///< world frame
  double cloud_resolution_m = 0.01;
  LabelSet labels;
  std::vector<TimedPose> trajectory;
  std::vector<TimedPose> truth;                     ///< empty: none
  std::optional<AbsoluteTrajectoryError> absolute;  ///< set if there is truth

  /// One frame of the run and what was taken as moving in it, to compare the map with. Empty images: left out.
  cv::Mat3b sample_bgr;
  cv::Mat1b sample_dynamic;
  SE3 sample_T_world_camera = SE3::Identity();
  std::shared_ptr<const CameraModel> camera;
};

/// Draws the map from above with the path (and the true one), the position error over time, and below one image with
/// what moved in it, and the map seen from the same pose in colour and by label.
/// @return 1640 x 1200 pixels
cv::Mat3b drawOverview(const OverviewContent& content);

}  // namespace semantic_vslam
