// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/motion/mask_cleanup.h"

#include <opencv2/imgproc.hpp>

namespace semantic_vslam {
namespace {

void morph(cv::Mat1b& mask, int operation, int diameter_px, float cell_px) {
  const int diameter = cvRound(static_cast<float>(diameter_px) / cell_px) | 1;  // odd, so that the mask does not shift
  if (diameter < 3) return;
  // A closing at the border must not eat the mask: OpenCV's default border value is neutral for both operations.
  cv::morphologyEx(mask, mask, operation, cv::getStructuringElement(cv::MORPH_ELLIPSE, {diameter, diameter}));
}

}  // namespace

cv::Mat1b cleanMask(const cv::Mat1b& mask, float cell_px, const MaskCleanupConfig& config) {
  cv::Mat1b cleaned = mask > 0;
  morph(cleaned, cv::MORPH_OPEN, config.open_px, cell_px);
  morph(cleaned, cv::MORPH_CLOSE, config.close_px, cell_px);
  cv::Mat1i regions, stats;
  cv::Mat1d centroids;
  cv::connectedComponentsWithStats(cleaned, regions, stats, centroids, 8, CV_32S);
  const auto min_cells = static_cast<int>(static_cast<float>(config.min_area_px) / (cell_px * cell_px));
  for (int y = 0; y < cleaned.rows; ++y) {
    for (int x = 0; x < cleaned.cols; ++x) {
      if (stats(regions(y, x), cv::CC_STAT_AREA) < min_cells) cleaned(y, x) = 0;
    }
  }
  return cleaned;
}

}  // namespace semantic_vslam
