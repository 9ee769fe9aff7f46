// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace semantic_vslam::synthetic {

/// Colour image with its mip pyramid, so that a surface far away neither shimmers nor aliases. It repeats in u and v.
class Texture {
 public:
  /// @param bgr  8-bit BGR; width and height are powers of two (asserted).
  explicit Texture(const cv::Mat3b& bgr);

  int width() const { return levels_.front().cols; }
  int height() const { return levels_.front().rows; }

  /// Trilinear look-up.
  /// @param u, v   position in images: 0..1 spans the image once, any value wraps; v grows downwards
  /// @param level  0 = full resolution, each step halves it; fractions blend, values outside clamp
  /// @return BGR, 0..255
  cv::Vec3f sample(float u, float v, float level) const;

 private:
  std::vector<cv::Mat3b> levels_;
};

}  // namespace semantic_vslam::synthetic
