// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/segmentation/label_upsampling.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace semantic_vslam {
namespace {

/// Where an output row or column lies in the grid: between cell `low` and `high`, `weight` of the way.
struct Tap {
  int low = 0;
  int high = 0;
  float weight = 0.0F;
};

/// Pixel centres are aligned: output i + 0.5 of `count` shows start + (i + 0.5) / count * length of the grid.
std::vector<Tap> makeTaps(double start, double length, int cells, int count) {
  std::vector<Tap> taps(count);
  for (int i = 0; i < count; ++i) {
    const double at = std::clamp(start + (i + 0.5) / count * length - 0.5, 0.0, cells - 1.0);
    taps[i].low = static_cast<int>(at);
    taps[i].high = std::min(taps[i].low + 1, cells - 1);
    taps[i].weight = static_cast<float>(at - taps[i].low);
  }
  return taps;
}

const float* scoresAt(const LogitGrid& grid, int x, int y) {
  return grid.data + (static_cast<std::size_t>(y) * grid.size.width + x) * grid.cell_step;
}

/// Best class of every cell, 16 bit since a network may know more than 255 classes.
cv::Mat_<std::uint16_t> bestClasses(const LogitGrid& grid) {
  cv::Mat_<std::uint16_t> best(grid.size, static_cast<std::uint16_t>(0));
  cv::Mat1f best_score(grid.size);
  const int cells = grid.size.area();
  auto* best_of = best.ptr<std::uint16_t>();
  auto* score_of = best_score.ptr<float>();
  for (int i = 0; i < cells; ++i) score_of[i] = grid.data[i * grid.cell_step];
  for (int k = 1; k < grid.classes; ++k) {
    const float* scores = grid.data + k * grid.class_step;
    for (int i = 0; i < cells; ++i) {
      const float score = scores[i * grid.cell_step];
      if (score > score_of[i]) {
        score_of[i] = score;
        best_of[i] = static_cast<std::uint16_t>(k);
      }
    }
  }
  return best;
}

int bestBetween(const LogitGrid& grid, const Tap& x, const Tap& y) {
  const float* a = scoresAt(grid, x.low, y.low);
  const float* b = scoresAt(grid, x.high, y.low);
  const float* c = scoresAt(grid, x.low, y.high);
  const float* d = scoresAt(grid, x.high, y.high);
  const float wb = x.weight * (1.0F - y.weight), wc = (1.0F - x.weight) * y.weight, wd = x.weight * y.weight;
  const float wa = 1.0F - wb - wc - wd;
  int best = 0;
  float best_score = 0.0F;
  for (int k = 0; k < grid.classes; ++k) {
    const std::size_t at = k * grid.class_step;
    const float score = wa * a[at] + wb * b[at] + wc * c[at] + wd * d[at];
    if (k == 0 || score > best_score) {
      best = k;
      best_score = score;
    }
  }
  return best;
}

/// Probability of each cell that one of the label's classes is there.
cv::Mat1f probability(const LogitGrid& grid, const std::vector<std::uint8_t>& lut, std::uint8_t label) {
  cv::Mat1f likely(grid.size, 0.0F), all(grid.size, 0.0F), largest(grid.size, -std::numeric_limits<float>::infinity());
  const int cells = grid.size.area();
  auto* const likely_of = likely.ptr<float>();
  auto* const all_of = all.ptr<float>();
  auto* const largest_of = largest.ptr<float>();
  for (int k = 0; k < grid.classes; ++k) {
    const float* scores = grid.data + k * grid.class_step;
    for (int i = 0; i < cells; ++i) largest_of[i] = std::max(largest_of[i], scores[i * grid.cell_step]);
  }
  for (int k = 0; k < grid.classes; ++k) {
    const float* scores = grid.data + k * grid.class_step;
    for (int i = 0; i < cells; ++i) {
      const float e = std::exp(scores[i * grid.cell_step] - largest_of[i]);
      all_of[i] += e;
      if (lut[k] == label) likely_of[i] += e;
    }
  }
  return likely / all;
}

}  // namespace

cv::Mat1b upsampleLikely(const LogitGrid& grid, const cv::Rect2d& region, const cv::Size& size,
                         const std::vector<std::uint8_t>& lut, std::uint8_t label, float least) {
  const cv::Mat1f likely = probability(grid, lut, label);
  const std::vector<Tap> columns = makeTaps(region.x, region.width, grid.size.width, size.width);
  const std::vector<Tap> rows = makeTaps(region.y, region.height, grid.size.height, size.height);
  cv::Mat1b out(size, std::uint8_t{0});
  cv::Mat1f line(1, grid.size.width);
  for (int v = 0; v < size.height; ++v) {
    const Tap& y = rows[v];
    const float *upper = likely[y.low], *lower = likely[y.high];
    float* between = line[0];
    for (int x = 0; x < line.cols; ++x) between[x] = upper[x] + y.weight * (lower[x] - upper[x]);
    if (*std::max_element(between, between + line.cols) < least) continue;
    std::uint8_t* to = out[v];
    for (int u = 0; u < size.width; ++u) {
      const Tap& x = columns[u];
      to[u] = between[x.low] + x.weight * (between[x.high] - between[x.low]) < least ? 0 : 255;
    }
  }
  return out;
}

cv::Mat1b upsampleBestLabels(const LogitGrid& grid, const cv::Rect2d& region, const cv::Size& size,
                             const std::vector<std::uint8_t>& lut) {
  assert(lut.size() == static_cast<std::size_t>(grid.classes));
  const cv::Mat_<std::uint16_t> best = bestClasses(grid);
  const std::vector<Tap> columns = makeTaps(region.x, region.width, grid.size.width, size.width);
  const std::vector<Tap> rows = makeTaps(region.y, region.height, grid.size.height, size.height);
  cv::Mat1b labels(size);
  for (int v = 0; v < size.height; ++v) {
    const Tap& y = rows[v];
    const std::uint16_t* upper = best[y.low];
    const std::uint16_t* lower = best[y.high];
    std::uint8_t* out = labels[v];
    for (int u = 0; u < size.width; ++u) {
      const Tap& x = columns[u];
      const std::uint16_t k = upper[x.low];
      const bool agree = k == upper[x.high] && k == lower[x.low] && k == lower[x.high];
      out[u] = lut[agree ? k : bestBetween(grid, x, y)];
    }
  }
  return labels;
}

cv::Mat1b upsampleLabels(const cv::Mat1b& labels, const cv::Rect2d& region, const cv::Size& size) {
  const auto cellOf = [](double start, double length, int cells, int count, int i) {
    return std::clamp(static_cast<int>(std::floor(start + (i + 0.5) / count * length)), 0, cells - 1);
  };
  std::vector<int> columns(size.width);
  for (int u = 0; u < size.width; ++u) columns[u] = cellOf(region.x, region.width, labels.cols, size.width, u);
  cv::Mat1b out(size);
  for (int v = 0; v < size.height; ++v) {
    const std::uint8_t* row = labels[cellOf(region.y, region.height, labels.rows, size.height, v)];
    for (int u = 0; u < size.width; ++u) out(v, u) = row[columns[u]];
  }
  return out;
}

}  // namespace semantic_vslam
