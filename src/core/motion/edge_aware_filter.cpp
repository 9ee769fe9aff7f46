// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "semantic_vslam/core/motion/edge_aware_filter.h"

#include <algorithm>
#include <cmath>

namespace semantic_vslam {
namespace {

// A relative depth step of this share between neighbouring cells counts like the filter's whole reach.
constexpr float kStepShare = 0.05F;
constexpr float kHoleStep = 0.5F;  // what a hole counts for, in the same terms
constexpr int kPasses = 2;

/// Distance between neighbouring cells in the transformed domain, as share of the reach beyond the plain one cell.
float stepBetween(float a, float b) {
  if (a <= 0.0F || b <= 0.0F) return kHoleStep;
  return std::min(std::abs(a - b) / (kStepShare * std::min(a, b)), 8.0F);
}

/// Feedback coefficients: how much of a neighbour's mean passes on. x: from the left, y: from above.
struct Coefficients {
  cv::Mat1f x, y;
};

Coefficients coefficients(const cv::Mat1f& depth_m, float reach_cells) {
  // a^d with a = exp(-sqrt(2) / sigma); steps that cost 0.1 or less of the reach are taken as even surface.
  Coefficients out{cv::Mat1f(depth_m.size(), 0.0F), cv::Mat1f(depth_m.size(), 0.0F)};
  const float plain = std::exp(-std::sqrt(2.0F) / reach_cells);
  const auto factor = [plain](float step) { return plain / (1.0F + 3.0F * step * step * (1.0F + 4.0F * step * step)); };
  for (int y = 0; y < depth_m.rows; ++y) {
    for (int x = 0; x < depth_m.cols; ++x) {
      const float here = depth_m(y, x);
      if (x > 0) out.x(y, x) = factor(stepBetween(depth_m(y, x - 1), here));
      if (y > 0) out.y(y, x) = factor(stepBetween(depth_m(y - 1, x), here));
    }
  }
  return out;
}

void passRows(cv::Mat2f& image, const cv::Mat1f& feedback) {
  for (int y = 0; y < image.rows; ++y) {
    cv::Vec2f* row = image[y];
    const float* a = feedback[y];
    for (int x = 1; x < image.cols; ++x) row[x] += a[x] * (row[x - 1] - row[x]);
    for (int x = image.cols - 2; x >= 0; --x) row[x] += a[x + 1] * (row[x + 1] - row[x]);
  }
}

void passColumns(cv::Mat2f& image, const cv::Mat1f& feedback) {
  for (int y = 1; y < image.rows; ++y) {
    cv::Vec2f *row = image[y], *above = image[y - 1];
    const float* a = feedback[y];
    for (int x = 0; x < image.cols; ++x) row[x] += a[x] * (above[x] - row[x]);
  }
  for (int y = image.rows - 2; y >= 0; --y) {
    cv::Vec2f *row = image[y], *below = image[y + 1];
    const float* a = feedback[y + 1];
    for (int x = 0; x < image.cols; ++x) row[x] += a[x] * (below[x] - row[x]);
  }
}

}  // namespace

cv::Mat1f filterAlongDepth(const cv::Mat1f& values, const cv::Mat1f& weights, const cv::Mat1f& depth_m,
                           float reach_cells) {
  const Coefficients feedback = coefficients(depth_m, reach_cells);
  cv::Mat2f sums(values.size());
  for (int y = 0; y < values.rows; ++y) {
    for (int x = 0; x < values.cols; ++x) sums(y, x) = {values(y, x) * weights(y, x), weights(y, x)};
  }
  for (int pass = 0; pass < kPasses; ++pass) {
    passRows(sums, feedback.x);
    passColumns(sums, feedback.y);
  }
  cv::Mat1f mean(values.size());
  for (int y = 0; y < values.rows; ++y) {
    for (int x = 0; x < values.cols; ++x) mean(y, x) = sums(y, x)[1] > 1e-6F ? sums(y, x)[0] / sums(y, x)[1] : 0.0F;
  }
  return mean;
}

}  // namespace semantic_vslam
