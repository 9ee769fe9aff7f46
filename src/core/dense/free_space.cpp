// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/dense/free_space.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace semantic_vslam {

FreeSpaceView makeFreeSpaceView(const RgbdFrame& frame, const cv::Mat1b& excluded, double depth_noise_m_per_m2,
                                int cell_px) {
  assert(excluded.empty() || excluded.size() == frame.depth_m.size());
  const CameraModel& camera = *frame.camera;
  const int cols = camera.width() / cell_px, rows = camera.height() / cell_px;
  FreeSpaceView view{cv::Mat1w(rows, cols, std::uint16_t{0}), camera.fx() / cell_px, camera.fy() / cell_px,
                     (camera.cx() + 0.5) / cell_px - 0.5, (camera.cy() + 0.5) / cell_px - 0.5};
  const auto noise = static_cast<float>(3.0 * depth_noise_m_per_m2);
  cv::Mat1b silenced(rows, cols, std::uint8_t{0});
  for (int v = 0; v < frame.depth_m.rows; ++v) {
    for (int u = 0; u < frame.depth_m.cols; ++u) {
      const cv::Vec2f& ray = camera.rays()(v, u);
      const int col = static_cast<int>(std::lround(view.fx_cells * ray[0] + view.cx_cells));
      const int row = static_cast<int>(std::lround(view.fy_cells * ray[1] + view.cy_cells));
      if (col < 0 || row < 0 || col >= cols || row >= rows) continue;
      if (!excluded.empty() && excluded(v, u) != 0) silenced(row, col) = 255;
      const float z_m = frame.depth_m(v, u);
      if (z_m <= 0.0F) continue;
      const float free_m = z_m - noise * z_m * z_m;
      const auto free_mm = static_cast<std::uint16_t>(std::clamp(free_m * 1000.0F, 1.0F, 65535.0F));
      std::uint16_t& nearest = view.free_mm(row, col);
      if (nearest == 0 || free_mm < nearest) nearest = free_mm;
    }
  }
  view.free_mm.setTo(0, silenced);
  return view;
}

}  // namespace semantic_vslam
