// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "semantic_vslam/core/motion/mask_cleanup.h"

#include <opencv2/imgproc.hpp>
#include <vector>

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
  cv::Mat1i labels;
  const int count = cv::connectedComponents(cleaned, labels, 8, CV_32S);
  const auto regions = static_cast<std::size_t>(count);
  std::vector<int> cells(regions, 0);
  for (int y = 0; y < cleaned.rows; ++y) {
    const int* row = labels[y];
    for (int x = 0; x < cleaned.cols; ++x) ++cells[static_cast<std::size_t>(row[x])];
  }
  const auto min_cells = static_cast<int>(static_cast<float>(config.min_area_px) / (cell_px * cell_px));
  std::vector<uchar> keep(regions, 0);
  for (std::size_t i = 1; i < regions; ++i) keep[i] = cells[i] >= min_cells ? 255 : 0;
  for (int y = 0; y < cleaned.rows; ++y) {
    const int* row = labels[y];
    uchar* out = cleaned[y];
    for (int x = 0; x < cleaned.cols; ++x) out[x] = keep[static_cast<std::size_t>(row[x])];
  }
  return cleaned;
}

}  // namespace semantic_vslam
