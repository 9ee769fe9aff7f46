// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

#include "core/motion/work_grid.h"
#include "semantic_vslam/core/geometry/se3.h"
#include "semantic_vslam/core/motion/motion_config.h"

namespace semantic_vslam {

/// A point seen in the present frame, and where the flow says it was in the previous one.
struct FlowPoint {
  Eigen::Vector3f point_current;  ///< metres, from the present depth
  Eigen::Vector2f ray_previous;   ///< x/z, y/z in the previous camera
  float depth_previous_m = 0.0F;  ///< measured there; 0 = none
  float weight = 1.0F;            ///< trust that the point stands still, 0 .. 1
};

struct CameraMotion {
  bool valid = false;
  SE3 T_previous_current = SE3::Identity();
  double translation_sigma_m = 0.0;  ///< standard deviation along the worst axis
  double rotation_sigma_rad = 0.0;
  double flow_sigma_px = 0.0;  ///< spread of the inliers' flow about the rigid flow, px of the full image
  int inliers = 0;
  double inlier_share = 0.0;  ///< of the points' weight
};

/// Picks textured points with depth, spread evenly over the image.
/// @param flow_cells  grid size, cells: x - (position in the previous frame)
/// @param static_weight  grid size, 0 .. 1: how surely the cell stands still; empty: all do
std::vector<FlowPoint> selectFlowPoints(const GridFrame& previous, const GridFrame& current,
                                        const cv::Mat2f& flow_cells, const cv::Mat1f& static_weight,
                                        const WorkGrid& grid);

/// The camera's motion that moves the static points as the flow and both depth images say.
///
/// Gauss-Newton with Geman-McClure weights whose scale is narrowed step by step, started from the prediction and from
/// rest. Where both explain too little, some motions that few points agree on are tried (RANSAC), and one has to
/// explain clearly more than they do. What counts there is the surface that moves with it, not the part of the image:
/// somebody who steps away within arm's length covers more of the view than the room, but less surface. Where neither
/// is larger, the motion that agrees with the past is kept.
/// @param T_previous_current_predicted  e.g. the last motion again (constant velocity)
/// @param step_s  between the two frames: the longer, the less the prediction counts
CameraMotion estimateCameraMotion(const std::vector<FlowPoint>& points, const WorkGrid& grid,
                                  const SE3& T_previous_current_predicted, double step_s,
                                  const RigidFlowConfig& config);

/// Depth noise of structured light and stereo, standard deviation in metres.
inline float depthSigma(const RigidFlowConfig& config, float depth_m) {
  return static_cast<float>(config.depth_noise.motion_m) * std::max(depth_m * depth_m, 0.25F);
}

}  // namespace semantic_vslam
