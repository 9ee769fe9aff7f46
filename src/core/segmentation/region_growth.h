// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <opencv2/core.hpp>
#include <vector>

#include "core/labels/connected_regions.h"

namespace semantic_vslam {

/// Eq. (2): centroid (m10 / m00, m01 / m00) of a mask by its moments.
struct MaskMoments {
  double m00 = 0.0, m10 = 0.0, m01 = 0.0;
  void add(const cv::Point& pixel) {
    m00 += 1.0;
    m10 += pixel.x;
    m01 += pixel.y;
  }
  cv::Point2d centroid() const { return {m10 / m00, m01 / m00}; }
};

/// One connected mask: its pixels and where it is grown from.
struct GrownMask {
  const int* pixels = nullptr;  ///< row * width + column, in raster order
  std::size_t size_px = 0;
  MaskMoments moments;
  int seed = -1;  ///< pixel; -1: the mask has no depth
};

inline float squaredDistance(const cv::Vec3f& a, const cv::Vec3f& b) {
  const float dx = a[0] - b[0], dy = a[1] - b[1], dz = a[2] - b[2];
  return dx * dx + dy * dy + dz * dz;
}

/// Whether growth steps from one pixel of a mask to a neighbouring one, and whether one stands clearly behind another.
class Steps {
 public:
  /// @param points_m  of the masks' pixels; z = 0: hole
  /// @param reach_m2  of the same: squared distance within which the next pixel of the mask belongs to it
  Steps(const ConnectedRegions& masks, const cv::Mat3f& points_m, const cv::Mat1f& reach_m2)
      : mask_of_(masks.id.ptr<int>()), point_m_(points_m.ptr<cv::Vec3f>()), reach_m2_(reach_m2.ptr<float>()) {}

  bool hasDepth(int i) const { return point_m_[i][2] > 0.0F; }
  bool sameMask(int a, int b) const { return mask_of_[a] == mask_of_[b]; }

  /// Both in one mask, and both holes or closer than T.
  bool joined(int a, int b) const {
    if (!sameMask(a, b)) return false;
    if (!hasDepth(a) || !hasDepth(b)) return hasDepth(a) == hasDepth(b);
    return squaredDistance(point_m_[a], point_m_[b]) < std::min(reach_m2_[a], reach_m2_[b]);
  }
  /// @return the one of two pixels with depth that another surface hides partly; -1 if there is no such step.
  int behind(int a, int b) const {
    constexpr float kClearSteps = 4.0F;  // several T: noise does not look like an edge
    const float za = point_m_[a][2], zb = point_m_[b][2];
    if ((za - zb) * (za - zb) < kClearSteps * kClearSteps * std::min(reach_m2_[a], reach_m2_[b])) return -1;
    return za > zb ? a : b;
  }

 private:
  const int* mask_of_;
  const cv::Vec3f* point_m_;
  const float* reach_m2_;
};

}  // namespace semantic_vslam
