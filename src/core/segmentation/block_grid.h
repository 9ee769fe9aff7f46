// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <opencv2/core.hpp>
#include <vector>

#include "semantic_vslam/core/segmentation/segmentation_config.h"

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
    const T* row = image[middleOfBlock(v, stride, image.rows)];
    const T* from = row + stride / 2;
    T* to = grid[v];
    const int last = grid.cols - 1;
    for (int u = 0; u < last; ++u, from += stride) to[u] = *from;
    to[last] = row[middleOfBlock(last, stride, image.cols)];
  }
}

/// Gives every pixel of a row its block's value, so that pixels are compared with their blocks several at once.
/// @param stride  at most kMaxBlockStride  @param row  of the grid
/// @param memory  for the result; grown at need
/// @return the pixels, at least as many as the image is wide
template <class T>
const T* expandRow(int stride, const cv::Mat_<T>& grid, int row, std::vector<T>& memory) {
  assert(stride <= kMaxBlockStride);
  memory.resize(static_cast<std::size_t>(grid.cols) * stride + kMaxBlockStride);
  const T* value = grid[row];
  T* to = memory.data();
  // A fixed number of copies is one or two stores; the next block writes over those that are too many.
  for (int block = 0; block < grid.cols; ++block, to += stride) std::fill_n(to, kMaxBlockStride, value[block]);
  return memory.data();
}

}  // namespace semantic_vslam
