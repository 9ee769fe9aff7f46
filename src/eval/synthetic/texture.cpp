// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "eval/synthetic/texture.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace semantic_vslam::synthetic {
namespace {

[[maybe_unused]] bool isPowerOfTwo(int n) { return n > 0 && (n & (n - 1)) == 0; }

/// std::floor is a library call on plain x86-64, and this runs millions of times a frame.
int floorToInt(float x) {
  const int truncated = static_cast<int>(x);
  return truncated - (x < static_cast<float>(truncated) ? 1 : 0);
}

cv::Vec3f bilinear(const cv::Mat3b& image, float u, float v) {
  const float x = u * static_cast<float>(image.cols) - 0.5F, y = v * static_cast<float>(image.rows) - 0.5F;
  const int x_floor = floorToInt(x), y_floor = floorToInt(y);
  const float dx = x - static_cast<float>(x_floor), dy = y - static_cast<float>(y_floor);
  const int x0 = x_floor & (image.cols - 1), x1 = (x0 + 1) & (image.cols - 1);
  const int y0 = y_floor & (image.rows - 1), y1 = (y0 + 1) & (image.rows - 1);
  const cv::Vec3b* top = image.ptr<cv::Vec3b>(y0);
  const cv::Vec3b* bottom = image.ptr<cv::Vec3b>(y1);
  const float w00 = (1 - dx) * (1 - dy), w01 = dx * (1 - dy), w10 = (1 - dx) * dy, w11 = dx * dy;
  cv::Vec3f color;
  for (int c = 0; c < 3; ++c)
    color[c] = w00 * top[x0][c] + w01 * top[x1][c] + w10 * bottom[x0][c] + w11 * bottom[x1][c];
  return color;
}

}  // namespace

Texture::Texture(const cv::Mat3b& bgr) {
  assert(isPowerOfTwo(bgr.cols) && isPowerOfTwo(bgr.rows));
  levels_.push_back(bgr.clone());
  while (levels_.back().cols > 1 || levels_.back().rows > 1) {
    const cv::Size half(std::max(1, levels_.back().cols / 2), std::max(1, levels_.back().rows / 2));
    cv::Mat3b next;
    cv::resize(levels_.back(), next, half, 0, 0, cv::INTER_AREA);
    levels_.push_back(next);
  }
}

cv::Vec3f Texture::sample(float u, float v, float level) const {
  const auto last = static_cast<int>(levels_.size()) - 1;
  const float clamped = std::clamp(level, 0.0F, static_cast<float>(last));
  const int fine = static_cast<int>(clamped);
  const float blend = clamped - static_cast<float>(fine);
  const cv::Vec3f sharp = bilinear(levels_[fine], u, v);
  if (blend < 1e-3F || fine == last) return sharp;
  return sharp * (1 - blend) + bilinear(levels_[fine + 1], u, v) * blend;
}

}  // namespace semantic_vslam::synthetic
