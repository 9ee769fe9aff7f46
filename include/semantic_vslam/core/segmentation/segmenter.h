// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <opencv2/core.hpp>

#include "semantic_vslam/core/common/label_set.h"

namespace semantic_vslam {

/// What a network says about an image; both of the image's size.
struct Segmentation {
  cv::Mat1b labels;         ///< best class of each pixel: indices into the network's label set
  cv::Mat1b weak_people{};  ///< 255 where a person is likely enough to be looked at (weak_person); empty: not known
};

/// A semantic network. Implementations are not thread-safe: one caller at a time.
class Segmenter {
 public:
  virtual ~Segmenter() = default;
  virtual const LabelSet& labels() const = 0;
  /// @param bgr  height x width, 8-bit BGR, any size
  /// @throws ModelError if the network fails at run time.
  virtual Segmentation segment(const cv::Mat3b& bgr) = 0;
};

}  // namespace semantic_vslam
