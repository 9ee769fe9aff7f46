// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

#include "ros/node_inputs.h"
#include "semantic_vslam/core/motion/motion_result.h"

namespace semantic_vslam {

/// Takes in what the motion stage says of each frame: motion/mask and motion/report, put together by stamp.
/// @param sink  must not wait
void takeMotion(NodeInputs& inputs, std::function<void(Stamp, const MotionResult&)> sink);

}  // namespace semantic_vslam
