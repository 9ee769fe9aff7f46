// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include "core/motion/camera_motion.h"
#include "core/motion/work_grid.h"
#include "semantic_vslam/core/motion/motion_config.h"

namespace semantic_vslam {

/// Measured flow against the flow that the camera's motion and the depth image predict. All of the grid's size.
struct RigidFlowResidual {
  cv::Mat1f amplitude_px;  ///< eq. (1) on the difference, px of the full image; NaN where the flow leaves the image
  cv::Mat1f sigmas;        ///< the same over its standard deviation; NaN as above
  cv::Mat2f previous;      ///< where the rigid scene puts the cell in the previous frame, cells
  cv::Mat1b hidden;        ///< not 0: a still scene would have been hidden there, so brightness tells nothing
};

/// The prediction is a piece of the epipolar line: the projections of all depths that the cell's 3x3 neighbourhood and
/// the depth noise allow (of any depth in a hole). The residual is the distance from it, so a depth that is noisy,
/// shifted against colour or missing is no evidence of motion.
RigidFlowResidual computeRigidFlowResidual(const GridFrame& previous, const GridFrame& current,
                                           const cv::Mat2f& flow_cells, const CameraMotion& motion,
                                           const WorkGrid& grid, const RigidFlowConfig& config);

/// How much better the measured flow explains the brightness than the rigid flow does: 1 = clearly, 0 = as well (no
/// texture, or no difference between them), -1 = clearly worse (the flow of a neighbour smeared over something still).
/// @return grid size, -1 .. 1
cv::Mat1f compareBrightness(const GridFrame& previous, const GridFrame& current, const cv::Mat2f& flow_cells,
                            const RigidFlowResidual& residual);

}  // namespace semantic_vslam
