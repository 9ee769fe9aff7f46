// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace semantic_vslam {

/// Class scores of a coarse grid, float32. Score of class k at row y, column x:
/// data[k * class_step + (y * size.width + x) * cell_step], which fits both NCHW and NHWC.
struct LogitGrid {
  const float* data = nullptr;
  int classes = 0;
  cv::Size size;
  std::size_t class_step = 0;
  std::size_t cell_step = 0;
};

/// The label image that bilinear up-sampling of the scores and argmax at each pixel would give, without the cost of it:
/// where the four surrounding cells agree on the best class no convex mix of them can prefer another, so only pixels
/// between cells that differ are computed.
/// @param region  the part of the grid to show, in cells (x, y, width, height); a letterbox's padding is left out
/// @param lut        class -> label
/// @return lut[best class], size.height x size.width
cv::Mat1b upsampleBestLabels(const LogitGrid& grid, const cv::Rect2d& region, const cv::Size& size,
                             const std::vector<std::uint8_t>& lut);

/// Where classes of one label together are at least so likely (softmax over the scores, up-sampled bilinearly).
/// @param region, size, lut  as of upsampleBestLabels()
/// @return 255 there, else 0, size.height x size.width
cv::Mat1b upsampleLikely(const LogitGrid& grid, const cv::Rect2d& region, const cv::Size& size,
                         const std::vector<std::uint8_t>& lut, std::uint8_t label, float least);

/// Nearest-neighbour up-sampling of a region of a label image, in its pixels.
cv::Mat1b upsampleLabels(const cv::Mat1b& labels, const cv::Rect2d& region, const cv::Size& size);

}  // namespace semantic_vslam
