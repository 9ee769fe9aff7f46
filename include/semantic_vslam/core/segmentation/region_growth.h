// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <opencv2/core.hpp>
#include <vector>

#include "semantic_vslam/core/segmentation/connected_regions.h"

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

/// One connected mask: its pixels, where it is grown from and how far it may step.
struct GrownMask {
  const int* pixels = nullptr;  ///< row * width + column, in raster order
  std::size_t size_px = 0;
  MaskMoments moments;
  int seed = -1;                         ///< pixel; -1: the mask has no depth
  float squared_threshold_m2 = 0.0F;     ///< T^2 of eq. (4) at the reference depth
  float inverse_reference_depth = 0.0F;  ///< 1/m
};

inline float squaredDistance(const cv::Vec3f& a, const cv::Vec3f& b) {
  const float dx = a[0] - b[0], dy = a[1] - b[1], dz = a[2] - b[2];
  return dx * dx + dy * dy + dz * dz;
}

/// Whether growth steps from one pixel of a mask to a neighbouring one, and whether one stands clearly behind another.
class Steps {
 public:
  Steps(const ConnectedRegions& masks, const std::vector<GrownMask>& prepared, const cv::Mat3f& points_m)
      : mask_of_(masks.id.ptr<int>()), prepared_(prepared), point_m_(points_m.ptr<cv::Vec3f>()) {}

  bool hasDepth(int i) const { return point_m_[i][2] > 0.0F; }
  bool sameMask(int a, int b) const { return mask_of_[a] == mask_of_[b]; }

  /// Both in one mask, and both holes or closer than T.
  bool joined(int a, int b) const {
    if (!sameMask(a, b)) return false;
    if (!hasDepth(a) || !hasDepth(b)) return hasDepth(a) == hasDepth(b);
    return isBelow(squaredDistance(point_m_[a], point_m_[b]), 1.0F, a, b);
  }
  /// Whether a pixel of this depth next to pixel i is level with it, or one of the two has no depth.
  bool level(int i, float z) const {
    const float zi = point_m_[i][2];
    return z == 0.0F || zi == 0.0F || isBelow((z - zi) * (z - zi), 1.0F, i, i);
  }
  /// @return the one of two pixels with depth that another surface hides partly; -1 if there is no such step.
  int behind(int a, int b) const {
    constexpr float kClearSteps = 4.0F;  // several T: noise does not look like an edge
    const float za = point_m_[a][2], zb = point_m_[b][2];
    if (isBelow((za - zb) * (za - zb), kClearSteps, a, b)) return -1;
    return za > zb ? a : b;
  }

 private:
  /// Whether a distance is below T times `steps`. Pixels of a farther part lie farther apart: T grows with them.
  bool isBelow(float squared_m2, float steps, int a, int b) const {
    const GrownMask& mask = prepared_[mask_of_[a]];
    const float least_m2 = steps * steps * mask.squared_threshold_m2;
    if (squared_m2 < least_m2) return true;
    const float farther = std::min(point_m_[a][2], point_m_[b][2]) * mask.inverse_reference_depth;
    return squared_m2 < farther * farther * least_m2;
  }

  const int* mask_of_;
  const std::vector<GrownMask>& prepared_;
  const cv::Vec3f* point_m_;
};

}  // namespace semantic_vslam
