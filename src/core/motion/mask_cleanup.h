// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include "semantic_vslam/core/motion/motion_config.h"

namespace semantic_vslam {

/// Opening, closing, and removal of regions that are too small.
/// @param mask  8-bit, not 0 = dynamic  @param cell_px  size of one mask pixel in px of the full image
/// @return 8-bit, 255 = dynamic
cv::Mat1b cleanMask(const cv::Mat1b& mask, float cell_px, const MaskCleanupConfig& config);

}  // namespace semantic_vslam
