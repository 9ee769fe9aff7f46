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
constexpr int kRansacIterations = 500;

void selectPoints(const GridFrame& current, const cv::Mat2f& flow_cells, const cv::Mat1f& static_weight,
                  const WorkGrid& grid, std::vector<cv::Point2f>& previous_points,
                  std::vector<cv::Point2f>& current_points) {
  const auto usable = [&](int x, int y) { return static_weight.empty() || static_weight(y, x) >= 0.5F; };
  forEachTexturedBlock(current.texture, kBlockCells, usable, [&](const cv::Point& best) {
    const cv::Vec2f flow = flow_cells(best);
    const cv::Point2f now(static_cast<float>(best.x), static_cast<float>(best.y));
    const cv::Point2f before = now - cv::Point2f(flow[0], flow[1]);
    if (!grid.contains(before)) return;
    previous_points.push_back(before);
    current_points.push_back(now);
  });
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

}  // namespace semantic_vslam
