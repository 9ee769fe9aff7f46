// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <opencv2/core.hpp>

#include "semantic_vslam/core/segmentation/label_set.h"

namespace semantic_vslam {

/// A semantic network. Implementations are not thread-safe: one caller at a time.
class Segmenter {
 public:
  virtual ~Segmenter() = default;
  virtual const LabelSet& labels() const = 0;
  /// @param bgr  height x width, 8-bit BGR, any size
  /// @return label image of the same size: indices into labels(). @throws ModelError if the network fails at run time.
  virtual cv::Mat1b segment(const cv::Mat3b& bgr) = 0;
};

}  // namespace semantic_vslam
