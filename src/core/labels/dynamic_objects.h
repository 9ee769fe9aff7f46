// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "semantic_vslam/core/common/label_set.h"

namespace semantic_vslam {

/// One connected mask and the decision on it.
struct DynamicObject {
  std::uint8_t label = 0;
  cv::Rect box;  ///< px
  int mask_px = 0;
  double dynamic_share = 0.0;  ///< rho_i of eq. (5): share of the mask that moves
  bool moving = false;         ///< rho_i > phi
  bool removed = false;        ///< from pose and map: it is a person, or movable and moving
};

/// Eq. (5): an object whose share of moving pixels exceeds phi moves. People are removed whether they move or not,
/// movable things while they move, static things never (a person's shadow or a screen's picture moves on them).
/// @param labels  height x width, indices into label_set
/// @param moving  height x width, MotionResult::moving; 128 and more moves; empty: nothing moves
/// @param removal_mask  if not null, set to 255 on removed objects and 0 elsewhere, height x width
/// @return every connected mask that is not background, in the order of its first pixel.
std::vector<DynamicObject> decideDynamic(const cv::Mat1b& labels, const LabelSet& label_set, const cv::Mat1b& moving,
                                         double phi, cv::Mat1b* removal_mask);

/// @return 255 where the label is a class of people, 0 elsewhere, height x width
cv::Mat1b maskOfPeople(const cv::Mat1b& labels, const LabelSet& label_set);

}  // namespace semantic_vslam
