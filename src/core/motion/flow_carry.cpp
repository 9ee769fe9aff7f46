// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "semantic_vslam/core/motion/flow_carry.h"

namespace semantic_vslam {

cv::Mat1f carryWithFlow(const cv::Mat1f& map, const cv::Mat2f& flow_cells, const cv::Mat1f& previous_depth_m,
                        const cv::Mat1f& depth_m, float dt_s, float fallback) {
  cv::Mat1f carried(map.size(), fallback);
  const auto right = static_cast<float>(map.cols - 1), bottom = static_cast<float>(map.rows - 1);
  for (int y = 0; y < map.rows; ++y) {
    const cv::Vec2f* flow = flow_cells[y];
    const float* depth = depth_m[y];
    float* out = carried[y];
    for (int x = 0; x < map.cols; ++x) {
      const float before_x = static_cast<float>(x) - flow[x][0], before_y = static_cast<float>(y) - flow[x][1];
      if (!(before_x >= 0.0F && before_y >= 0.0F && before_x <= right && before_y <= bottom)) continue;
      const float depth_before = previous_depth_m(static_cast<int>(before_y + 0.5F), static_cast<int>(before_x + 0.5F));
      if (isUncovered(depth[x], depth_before, dt_s)) continue;
      out[x] = sampleBilinear(map, before_x, before_y);
    }
  }
  return carried;
}

}  // namespace semantic_vslam
