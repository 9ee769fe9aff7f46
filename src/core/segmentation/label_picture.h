// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include "semantic_vslam/core/common/label_set.h"

namespace semantic_vslam {

/// @return the colour of each label, 8-bit BGR, same size; labels beyond the set are black.
cv::Mat3b labelColours(const cv::Mat1b& labels, const LabelSet& label_set);

/// The image with labelled pixels tinted in their colour and outlined, and a legend of the classes it shows.
cv::Mat3b drawLabels(const cv::Mat3b& bgr, const cv::Mat1b& labels, const LabelSet& label_set);

}  // namespace semantic_vslam
