// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/core.hpp>

#include "core/dense/free_space.h"

/// Signed distances to the surface, as one keyframe sees them and as a voxel keeps them (Curless and Levoy 1996).
/// Private to dense/.
namespace semantic_vslam {

/// Beyond this distance a voxel only knows on which side of the surface it is: three standard deviations of a Kinect's
/// depth at the far end of the map's range, 4 m, and no less than three voxels.
inline float truncationM(double voxel_m) { return std::max(0.09F, 3.0F * static_cast<float>(voxel_m)); }

/// Signed distance of points to the surface that one view saw.
class SurfaceDistance {
 public:
  explicit SurfaceDistance(const FreeSpaceView& view) : inverse_(view.inverse_depth), scale_m_(inverse_.size(), 0.0F) {
    // Inverse depth is a plane over the image where the surface is one: a x + b y + c = 1 / z, with x and y the ray's.
    // So aX + bY + cZ = 1 holds on the surface, and 1 - Z / z over the length of (a, b, c) is the distance from it.
    const auto fx = static_cast<float>(view.fx_cells), fy = static_cast<float>(view.fy_cells);
    for (int row = 0; row < inverse_.rows; ++row) {
      for (int col = 0; col < inverse_.cols; ++col) {
        const float here = inverse_(row, col);
        if (here <= 0.0F) continue;
        const float a = slope(row, col, 0, 1) * fx, b = slope(row, col, 1, 0) * fy;
        const float x = (static_cast<float>(col) - static_cast<float>(view.cx_cells)) / fx;
        const float y = (static_cast<float>(row) - static_cast<float>(view.cy_cells)) / fy;
        const float c = here - a * x - b * y;
        scale_m_(row, col) = 1.0F / std::sqrt(a * a + b * b + c * c);
      }
    }
  }

  /// @param col, row  cell that the point is seen in, between the cells' centres  @param z_m  its depth
  /// @param far_m  beyond twice this distance a coarse answer will do
  /// @return metres, above 0 before the surface; NaN where no surface was seen
  float at(float col, float row, float z_m, float far_m) const {
    const int near_col = static_cast<int>(col + 0.5F), near_row = static_cast<int>(row + 0.5F);
    const float here = inverse_(near_row, near_col);
    if (here <= 0.0F) return NAN;
    const float scale_m = scale_m_(near_row, near_col), coarse_m = (1.0F - here * z_m) * scale_m;
    if (std::abs(coarse_m) > 2.0F * far_m) return coarse_m;
    return (1.0F - interpolated(col, row, here) * z_m) * scale_m;
  }

 private:
  /// Two cells this much apart in inverse depth, per cell, are two surfaces: 80 degrees of incidence.
  bool joined(float a, float b) const { return a > 0.0F && b > 0.0F && std::abs(a - b) < 0.05F * std::max(a, b); }

  /// Change of inverse depth from cell to cell along one direction; 0 (frontal) where neighbours are no part of it.
  float slope(int row, int col, int down, int right) const {
    const float here = inverse_(row, col);
    const auto valueAt = [&](int r, int c) {
      return r < 0 || c < 0 || r >= inverse_.rows || c >= inverse_.cols ? 0.0F : inverse_(r, c);
    };
    const float before = valueAt(row - down, col - right), after = valueAt(row + down, col + right);
    const bool has_before = joined(here, before), has_after = joined(here, after);
    if (has_before && has_after) return 0.5F * (after - before);
    if (has_before) return here - before;
    return has_after ? after - here : 0.0F;
  }

  float interpolated(float col, float row, float here) const {
    const int left = static_cast<int>(std::floor(col)), top = static_cast<int>(std::floor(row));
    if (left < 0 || top < 0 || left + 1 >= inverse_.cols || top + 1 >= inverse_.rows) return here;
    const float tl = inverse_(top, left), tr = inverse_(top, left + 1), bl = inverse_(top + 1, left),
                br = inverse_(top + 1, left + 1);
    if (!joined(here, tl) || !joined(here, tr) || !joined(here, bl) || !joined(here, br)) return here;
    const float dx = col - static_cast<float>(left), dy = row - static_cast<float>(top);
    return (tl * (1 - dx) + tr * dx) * (1 - dy) + (bl * (1 - dx) + br * dx) * dy;
  }

  const cv::Mat1f inverse_;  // shares the view's data
  cv::Mat1f scale_m_;
};

/// A voxel's running mean of signed distances, as a share of the truncation. In whole numbers, the same on every
/// machine. Three views in a row that are far from it begin it anew: a thing was put there, or taken away.
class FusedDistance {
 public:
  FusedDistance() : weight_(0), far_(0) {}
  bool known() const { return weight_ > 0; }
  /// -1..1 of truncationM()
  float share() const { return static_cast<float>(value_) / kUnit; }
  static constexpr int kFullWeight = 64;

  /// How much one view's distance counts: by the inverse of its variance, 5 mm of which no range takes away (pose and
  /// calibration). @param sigma_m of one depth at this range  @return 1..kFullWeight
  static int weightOf(float sigma_m) {
    constexpr float kLeastM = 0.005F;
    const float share = kLeastM * kLeastM / (kLeastM * kLeastM + sigma_m * sigma_m);
    return std::max(1, static_cast<int>(kFullWeight * share));
  }
  void add(float share, int weight) {
    constexpr int kMost = 64 * kFullWeight;  // older views fade
    constexpr int kFar = kUnit / 2, kViewsToBeginAnew = 3;
    const int value = static_cast<int>(std::lround(std::clamp(share, -1.0F, 1.0F) * kUnit));
    far_ = weight_ > 0 && std::abs(value - value_) > kFar ? far_ + 1 : 0;
    if (far_ == kViewsToBeginAnew) weight_ = far_ = 0;
    const int sum = weight_ + weight;
    const int change = weight * (value - value_);
    value_ = static_cast<std::int16_t>(value_ + (change + (change > 0 ? sum : -sum) / 2) / sum);
    weight_ = static_cast<std::uint16_t>(std::min(sum, kMost));
  }

 private:
  static constexpr int kUnit = 10000;
  std::int16_t value_ = 0;
  std::uint16_t weight_ : 13;
  std::uint16_t far_ : 3;  // views in a row
};

}  // namespace semantic_vslam
