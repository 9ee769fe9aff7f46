// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <opencv2/core.hpp>
#include <vector>

#include "core/dense/keyframe_cloud.h"
#include "semantic_vslam/core/camera/camera_model.h"
#include "semantic_vslam/core/geometry/se3.h"

namespace semantic_vslam {

/// Draws a cloud as a camera at a pose would see it: each point is a square of its size in space, the nearest wins.
/// @param point_size_m  edge of a point, the cloud's resolution
/// @param color         of a point; LabelledPoint::bgr, or that of its label
/// @return as the camera records, light gray where there is no point
cv::Mat3b renderCloud(const std::vector<LabelledPoint>& cloud, const SE3& T_world_camera, const CameraModel& camera,
                      double point_size_m, const std::function<cv::Vec3b(const LabelledPoint&)>& color);

}  // namespace semantic_vslam
