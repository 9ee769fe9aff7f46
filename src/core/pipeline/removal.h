// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include "semantic_vslam/core/common/label_set.h"
#include "semantic_vslam/core/motion/motion_result.h"

namespace semantic_vslam {

/// What is removed from a frame: what moves, people, and all of a movable object of which a share above phi moves by
/// flow and depth, eq. (5).
/// @param motion  of the frame; its images may be empty: nothing is known to move
/// @param labels  of the frame, indices into label_set; empty: nobody has looked
/// @return height x width, 0..255, 128 and more is removed; motion.dynamic itself where there are no labels
cv::Mat1b removedPixels(const MotionResult& motion, const cv::Mat1b& labels, const LabelSet& label_set,
                        const RemovalConfig& config);

}  // namespace semantic_vslam
