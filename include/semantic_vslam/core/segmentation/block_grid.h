// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <opencv2/core.hpp>
#include <vector>

namespace semantic_vslam {

/// @return row or column of the image, of that many, that stands for one of the grid of blocks of stride x stride px:
/// the block's middle; the last block may be cut off
inline int middleOfBlock(int index, int stride, int count) { return std::min(index * stride + stride / 2, count - 1); }

/// The middle of each block of stride x stride px.
/// @param grid  result, ceil(height / stride) x ceil(width / stride); shares the image's memory at stride 1
template <class T>
void takeEvery(int stride, const cv::Mat_<T>& image, cv::Mat_<T>& grid) {
  if (stride == 1) {
    grid = image;
    return;
  }
  grid.create((image.rows + stride - 1) / stride, (image.cols + stride - 1) / stride);
  for (int v = 0; v < grid.rows; ++v) {
    const T* from = image[middleOfBlock(v, stride, image.rows)];
    T* to = grid[v];
    for (int u = 0; u < grid.cols; ++u) to[u] = from[middleOfBlock(u, stride, image.cols)];
  }
}

/// Gives every pixel of a row its block's value, so that pixels are compared with their blocks several at once.
/// @param row  of the grid  @param pixels  result; its size is the image's width
template <class T>
void expandRow(int stride, const cv::Mat_<T>& grid, int row, std::vector<T>& pixels) {
  const T* value = grid[row];
  T* to = pixels.data();
  const int width = static_cast<int>(pixels.size());
  for (int first = 0; first < stride; ++first) {
    for (int u = first, block = 0; u < width; u += stride, ++block) to[u] = value[block];
  }
}

}  // namespace semantic_vslam
