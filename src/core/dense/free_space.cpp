// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/dense/free_space.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/dense/keyframe_cloud.h"

namespace semantic_vslam {
namespace {

/// What falls into one cell.
struct CellSums {
  int pixels = 0, surface_pixels = 0;
  float nearest_m = 0.0F, inverse_sum = 0.0F;
  bool silenced = false;
  int someone_pixels = 0;
};

}  // namespace

FreeSpaceView makeFreeSpaceView(const RgbdFrame& frame, const cv::Mat1b& excluded, const cv::Mat1b& someone,
                                const KeyframeCloudConfig& config, int cell_px) {
  assert(excluded.empty() || excluded.size() == frame.depth_m.size());
  const CameraModel& camera = *frame.camera;
  const int cols = camera.width() / cell_px, rows = camera.height() / cell_px;
  FreeSpaceView view;
  view.free_mm.create(rows, cols);
  view.inverse_depth.create(rows, cols);
  view.fx_cells = camera.fx() / cell_px;
  view.fy_cells = camera.fy() / cell_px;
  view.cx_cells = (camera.cx() + 0.5) / cell_px - 0.5;
  view.cy_cells = (camera.cy() + 0.5) / cell_px - 0.5;
  view.noise_m_per_m2 = config.depth_noise.surfaces_m;
  const auto min_m = static_cast<float>(config.min_depth_m), max_m = static_cast<float>(config.max_depth_m);
  const cv::Mat1b edges = depthEdges(frame.depth_m, camera.fx(), config);
  std::vector<CellSums> cells(static_cast<std::size_t>(rows) * cols);
  for (int v = 0; v < frame.depth_m.rows; ++v) {
    for (int u = 0; u < frame.depth_m.cols; ++u) {
      const cv::Vec2f& ray = camera.rays()(v, u);
      const int col = static_cast<int>(std::lround(view.fx_cells * ray[0] + view.cx_cells));
      const int row = static_cast<int>(std::lround(view.fy_cells * ray[1] + view.cy_cells));
      if (col < 0 || row < 0 || col >= cols || row >= rows) continue;
      CellSums& cell = cells[static_cast<std::size_t>(row) * cols + col];
      ++cell.pixels;
      if (!excluded.empty() && excluded(v, u) != 0) cell.silenced = true;
      if (!someone.empty() && someone(v, u) != 0) ++cell.someone_pixels;
      const float z_m = frame.depth_m(v, u);
      if (z_m <= 0.0F) continue;
      if (cell.nearest_m == 0.0F || z_m < cell.nearest_m) cell.nearest_m = z_m;
      if (edges(v, u) != 0 || z_m < min_m || z_m > max_m) continue;
      cell.inverse_sum += 1.0F / z_m;
      ++cell.surface_pixels;
    }
  }
  // Masks reach over the outline, onto what is behind: only what lies well inside is surely of someone.
  constexpr int kOutlineCells = 2;
  cv::Mat1b inside(rows, cols);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    inside.data[i] = cells[i].pixels > 0 && cells[i].someone_pixels == cells[i].pixels ? 255 : 0;
  }
  cv::erode(inside, inside, cv::Mat(), {-1, -1}, kOutlineCells);
  const auto noise = static_cast<float>(3.0 * view.noise_m_per_m2);
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < cols; ++col) {
      const CellSums& cell = cells[static_cast<std::size_t>(row) * cols + col];
      std::uint16_t& free_mm = view.free_mm(row, col);
      float& inverse = view.inverse_depth(row, col);
      free_mm = 0;
      inverse = 0.0F;
      if (inside(row, col) != 0 && 2 * cell.surface_pixels >= cell.pixels) {
        inverse = -cell.inverse_sum / static_cast<float>(cell.surface_pixels);
      }
      if (cell.silenced || cell.pixels == 0) continue;
      const float free_m = cell.nearest_m - noise * cell.nearest_m * cell.nearest_m;
      free_mm = cell.nearest_m == 0.0F ? FreeSpaceView::kNoReturn
                                       : static_cast<std::uint16_t>(std::clamp(free_m * 1000.0F, 1.0F, 65534.0F));
      if (2 * cell.surface_pixels >= cell.pixels) {
        inverse = cell.inverse_sum / static_cast<float>(cell.surface_pixels);
      }
    }
  }
  return view;
}

}  // namespace semantic_vslam
