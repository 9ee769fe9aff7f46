// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "semantic_vslam/core/common/stamp.h"
#include "semantic_vslam/core/geometry/se3.h"

namespace semantic_vslam {

/// What explained the camera's own motion between frames n-1 and n.
enum class MotionModel { kNone = 0, kHomography = 1, kRigidFlow = 2 };

/// As in the configuration.
inline const char* motionModelName(MotionModel model) {
  switch (model) {
    case MotionModel::kHomography: return "homography";
    case MotionModel::kRigidFlow: return "rigid_flow";
    case MotionModel::kNone: break;
  }
  return "none";
}

/// What the motion stage says of one frame.
struct MotionResult {
  /// height x width, 8-bit: probability that the pixel is on a moving object, 0 = surely static, 255 = surely dynamic.
  /// 128 and more counts as dynamic. All 0 where no motion could be told, but for labels.
  cv::Mat1b dynamic;
  /// The same without semantic masks, by flow and depth alone, on the motion stage's working grid: Fi of eq. (5).
  cv::Mat1b moving;
  /// Dense flow from n-1 to n seen in frame n: flow(x_n) = x_n - x_{n-1}; 2 x float32, px of the full image, on the
  /// working grid (a quarter of the image's width and height by default). Empty for the first frame.
  cv::Mat2f flow_px;
  /// Flow amplitude that the camera's motion does not explain, eq. (1); size of flow_px, px; NaN = unknown.
  /// Empty where no model held.
  cv::Mat1f residual_px;
  /// False: what moves cannot be told, since there is no frame before, or it is too old, or nothing explains how the
  /// camera moved. Then people are in `dynamic` by labels alone, and without labels the frame is not mapped.
  bool told = true;
  MotionModel model = MotionModel::kNone;
  SE3 T_current_previous = SE3::Identity();  ///< camera motion by the rigid model; identity for the others
  int inliers = 0;                           ///< of the camera motion model
  double dynamic_share = 0.0;                ///< share of the working grid that is dynamic
  std::optional<Stamp> labels;  ///< of the frame whose labels are carried on in `dynamic`; nothing: no labels in it
};

}  // namespace semantic_vslam
