// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <opencv2/core.hpp>
#include <vector>

namespace semantic_vslam {

/// Parts of an image whose neighbouring pixels belong together.
struct ConnectedRegions {
  cv::Mat1i id;  ///< region of each pixel; -1: none
  int count = 0;
  std::vector<int> size_px;  ///< of each region
};

/// Splits pixels into 8-connected regions of those that `joined(a, b)` puts together; a and b are row * width + column.
/// Regions are numbered in the order of their first pixel. Union-find over one scan: linear in the number of pixels.
/// @tparam kTransitive  joined(a, b) and joined(b, c) imply joined(a, c), as equal labels do: half of the questions are
/// saved
/// @param pixels   the ones to split, in raster order as cv::findNonZero() gives them; others are in no region
/// @param regions  result; its memory is used again if it is large enough
template <bool kTransitive = false, class Joined>
void connectRegions(const cv::Size& size, const std::vector<cv::Point>& pixels, const Joined& joined,
                    ConnectedRegions& regions) {
  const int width = size.width;
  regions.id.create(size);
  regions.id.setTo(-1);
  regions.count = 0;
  regions.size_px.clear();
  int* parent = regions.id.ptr<int>();  // the forest lives in the result: a pixel's parent never comes after it
  const auto rootOf = [parent](int i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  const auto join = [&](int a, int b) {
    if (parent[b] < 0) return false;
    if (parent[a] == parent[b]) return true;
    if (!joined(a, b)) return false;
    const int root_a = rootOf(a), root_b = rootOf(b);
    parent[std::max(root_a, root_b)] = std::min(root_a, root_b);
    return true;
  };
  for (const cv::Point& p : pixels) {
    const int i = p.y * width + p.x;
    parent[i] = i;
    // The one above first, for it is most often joined to the other three already, being their neighbour.
    if (p.y > 0 && join(i, i - width) && kTransitive) continue;
    if (p.x > 0) join(i, i - 1);
    if (p.y == 0) continue;
    if (p.x > 0) join(i, i - width - 1);
    if (p.x + 1 < width) join(i, i - width + 1);
  }
  // Parents come first, so that one more scan turns the forest into numbers in place.
  for (const cv::Point& p : pixels) {
    const int i = p.y * width + p.x;
    if (parent[i] == i) {
      parent[i] = regions.count++;
      regions.size_px.push_back(1);
    } else {
      parent[i] = parent[parent[i]];
      ++regions.size_px[parent[i]];
    }
  }
}

}  // namespace semantic_vslam
