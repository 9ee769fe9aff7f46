// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <opencv2/core.hpp>

namespace semantic_vslam {

/// Mean of the four values about a position between pixels, weighed by nearness.
/// @param x0, y0  the upper left of the four, which all lie in the image  @param dx, dy  from it, 0 .. 1
template <class Value>
Value blendFour(const cv::Mat_<Value>& image, int x0, int y0, float dx, float dy) {
  const Value *top = image[y0] + x0, *bottom = image[y0 + 1] + x0;
  return (top[0] * (1 - dx) + top[1] * dx) * (1 - dy) + (bottom[0] * (1 - dx) + bottom[1] * dx) * dy;
}

/// The image at a position between its pixels; the caller ensures that it lies inside.
template <class Value>
Value sampleBilinear(const cv::Mat_<Value>& image, float x, float y) {
  const int x0 = std::min(static_cast<int>(x), image.cols - 2), y0 = std::min(static_cast<int>(y), image.rows - 2);
  return blendFour(image, x0, y0, x - static_cast<float>(x0), y - static_cast<float>(y0));
}

}  // namespace semantic_vslam
