// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/motion/homography_motion.h"

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace semantic_vslam {
namespace {

// One point per block of 6x6 cells: 520 at 160x120; a homography has 8 unknowns.
constexpr int kBlockCells = 6;
constexpr float kLeastTexture = 3.0F;  // gray levels per cell: below it the flow is interpolated, not measured
constexpr int kRansacIterations = 500;

void selectPoints(const GridFrame& current, const cv::Mat2f& flow_cells, const cv::Mat1f& static_weight,
                  const WorkGrid& grid, std::vector<cv::Point2f>& previous_points,
                  std::vector<cv::Point2f>& current_points) {
  for (int block_y = 0; block_y + kBlockCells <= grid.size().height; block_y += kBlockCells) {
    for (int block_x = 0; block_x + kBlockCells <= grid.size().width; block_x += kBlockCells) {
      cv::Point best(-1, -1);
      float best_texture = kLeastTexture;
      for (int y = block_y; y < block_y + kBlockCells; ++y) {
        for (int x = block_x; x < block_x + kBlockCells; ++x) {
          if (current.texture(y, x) <= best_texture) continue;
          if (!static_weight.empty() && static_weight(y, x) < 0.5F) continue;
          best_texture = current.texture(y, x);
          best = {x, y};
        }
      }
      if (best.x < 0) continue;
      const cv::Vec2f flow = flow_cells(best);
      const cv::Point2f now(static_cast<float>(best.x), static_cast<float>(best.y));
      const cv::Point2f before = now - cv::Point2f(flow[0], flow[1]);
      if (!grid.contains(before)) continue;
      previous_points.push_back(before);
      current_points.push_back(now);
    }
  }
}

cv::Point2d apply(const cv::Matx33d& H, double x, double y) {
  const cv::Vec3d p = H * cv::Vec3d(x, y, 1.0);
  return {p[0] / p[2], p[1] / p[2]};
}

}  // namespace

HomographyMotion estimateHomography(const GridFrame& current, const cv::Mat2f& flow_cells,
                                    const cv::Mat1f& static_weight, const WorkGrid& grid,
                                    const HomographyConfig& config) {
  HomographyMotion motion;
  std::vector<cv::Point2f> previous_points, current_points;
  selectPoints(current, flow_cells, static_weight, grid, previous_points, current_points);
  if (previous_points.size() < static_cast<std::size_t>(config.min_inliers)) return motion;
  cv::Mat inlier_mask;
  const cv::Mat H = cv::findHomography(previous_points, current_points, cv::RANSAC, config.ransac_px / grid.cellPx(),
                                       inlier_mask, kRansacIterations, 0.995);
  if (H.empty() || !cv::checkRange(H)) return motion;
  motion.H_current_previous = cv::Matx33d(H);
  motion.inliers = cv::countNonZero(inlier_mask);
  motion.valid = motion.inliers >= config.min_inliers && std::abs(cv::determinant(motion.H_current_previous)) > 1e-6;
  return motion;
}

cv::Mat1b warpPrevious(const GridFrame& previous, const GridFrame& current, const HomographyMotion& motion) {
  // From cells to the gray image, two pixels a cell: g = 2 c + 0.5.
  const cv::Matx33d gray_from_cell(2, 0, 0.5, 0, 2, 0.5, 0, 0, 1),
      cell_from_gray(0.5, 0, -0.25, 0, 0.5, -0.25, 0, 0, 1);
  cv::Mat1b warped = current.gray.clone();
  cv::warpPerspective(previous.gray, warped, gray_from_cell * motion.H_current_previous * cell_from_gray, warped.size(),
                      cv::INTER_LINEAR, cv::BORDER_TRANSPARENT);
  cv::Mat1b cells;
  cv::resize(warped, cells, current.cell_gray.size(), 0, 0, cv::INTER_AREA);
  return cells;
}

cv::Mat2f homographyFlow(const HomographyMotion& motion, cv::Size grid_size) {
  const cv::Matx33d H_previous_current = motion.H_current_previous.inv();
  cv::Mat2f flow(grid_size);
  for (int y = 0; y < grid_size.height; ++y) {
    for (int x = 0; x < grid_size.width; ++x) {
      const cv::Point2d before = apply(H_previous_current, x, y);
      flow(y, x) = {static_cast<float>(x - before.x), static_cast<float>(y - before.y)};
    }
  }
  return flow;
}

}  // namespace semantic_vslam
