// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/motion/flow_carry.h"

#include <limits>

#include "core/motion/work_grid.h"

namespace semantic_vslam {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// Whether a surface cannot be the one that was there because it lies behind it. Unknown depths (0) never tell.
bool isUncovered(float depth_m, float previous_depth_m, float dt_s) {
  if (depth_m <= 0.0F || previous_depth_m <= 0.0F) return false;
  // People recede at 2 m/s at most; the noise of both depths grows with the square of depth.
  return depth_m - previous_depth_m > 0.03F + 2.0F * dt_s + 0.015F * depth_m * depth_m;
}

}  // namespace

cv::Mat2f traceBack(const cv::Mat2f& flow_cells, const cv::Mat1f& previous_depth_m, const cv::Mat1f& surface_m,
                    double dt_s) {
  cv::Mat2f source(flow_cells.size());
  const auto right = static_cast<float>(source.cols - 1), bottom = static_cast<float>(source.rows - 1);
  for (int y = 0; y < source.rows; ++y) {
    const cv::Vec2f* flow = flow_cells[y];
    const float* surface = surface_m[y];
    cv::Vec2f* out = source[y];
    for (int x = 0; x < source.cols; ++x) {
      const cv::Vec2f before(static_cast<float>(x) - flow[x][0], static_cast<float>(y) - flow[x][1]);
      out[x] = {kNan, kNan};
      if (!(before[0] >= 0.0F && before[1] >= 0.0F && before[0] <= right && before[1] <= bottom)) continue;
      const float depth_before =
          previous_depth_m(static_cast<int>(before[1] + 0.5F), static_cast<int>(before[0] + 0.5F));
      if (!isUncovered(surface[x], depth_before, static_cast<float>(dt_s))) out[x] = before;
    }
  }
  return source;
}

cv::Mat1f carryAlong(const cv::Mat1f& map, const cv::Mat2f& source, float fallback) {
  cv::Mat1f carried(map.size());
  for (int y = 0; y < map.rows; ++y) {
    const cv::Vec2f* from = source[y];
    float* out = carried[y];
    for (int x = 0; x < map.cols; ++x) {
      const bool lost = !(from[x][0] >= 0.0F);  // NaN
      out[x] = lost ? fallback : sampleBilinear(map, from[x][0], from[x][1]);
    }
  }
  return carried;
}

}  // namespace semantic_vslam
