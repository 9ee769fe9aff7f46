// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/motion/edge_aware_filter.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core/hal/intrin.hpp>

namespace semantic_vslam {
namespace {

// A relative depth step of this share between neighbouring cells counts like the filter's whole reach.
constexpr float kStepShare = 0.05F;
constexpr float kHoleStep = 0.5F;  // what a hole counts for, in the same terms
constexpr int kPasses = 2;

/// How much of a neighbour's mean passes on, a^d with a = exp(-sqrt(2) / sigma); d grows with the step in depth, and
/// steps that cost 0.1 or less of the reach are taken as even surface. Without branches, so that it runs four at a
/// time.
float feedback(float depth_a_m, float depth_b_m, float plain) {
  constexpr float kLeastDepthM = 1e-3F;
  const float nearer = std::min(depth_a_m, depth_b_m);
  const float measured =
      std::min(std::abs(depth_a_m - depth_b_m) / (kStepShare * std::max(nearer, kLeastDepthM)), 8.0F);
  const float step = nearer < kLeastDepthM ? kHoleStep : measured;
  const float squared = step * step;
  return plain / (1.0F + 3.0F * squared * (1.0F + 4.0F * squared));
}

/// Feedback coefficients. x: from the left, y: from above.
struct Coefficients {
  cv::Mat1f x, y;
};

Coefficients coefficients(const cv::Mat1f& depth_m, float reach_cells) {
  Coefficients out{cv::Mat1f(depth_m.size(), 0.0F), cv::Mat1f(depth_m.size(), 0.0F)};
  const float plain = std::exp(-std::sqrt(2.0F) / reach_cells);
  for (int y = 0; y < depth_m.rows; ++y) {
    const float *here = depth_m[y], *above = depth_m[std::max(0, y - 1)];
    float *from_left = out.x[y], *from_above = out.y[y];
    for (int x = 1; x < depth_m.cols; ++x) from_left[x] = feedback(here[x - 1], here[x], plain);
    for (int x = 0; x < depth_m.cols; ++x) from_above[x] = feedback(above[x], here[x], plain);
  }
  return out;
}

/// b + a (b_before - b), of four channels at once.
cv::v_float32x4 blend(const cv::v_float32x4& here, const cv::v_float32x4& before, float a) {
  return here * cv::v_setall_f32(1.0F - a) + before * cv::v_setall_f32(a);
}

/// Forth and back along kRows rows from y on. Each step waits for the one before it, so rows are taken side by side.
template <int kRows>
void passRows(cv::Mat4f& channels, const cv::Mat1f& feedback_x, int y) {
  const int cols = channels.cols;
  float* row[kRows];
  const float* a[kRows];
  cv::v_float32x4 mean[kRows];
  for (int i = 0; i < kRows; ++i) {
    row[i] = channels.ptr<float>(y + i);
    a[i] = feedback_x[y + i];
    mean[i] = cv::v_load(row[i]);
  }
  const auto step = [&](int x, int link) {
    for (int i = 0; i < kRows; ++i) {
      mean[i] = blend(cv::v_load(row[i] + 4 * x), mean[i], a[i][link]);
      cv::v_store(row[i] + 4 * x, mean[i]);
    }
  };
  for (int x = 1; x < cols; ++x) step(x, x);
  for (int x = cols - 2; x >= 0; --x) step(x, x + 1);
}

void passAlongRows(cv::Mat4f& channels, const cv::Mat1f& feedback_x) {
  constexpr int kTogether = 4;
  int y = 0;
  for (; y + kTogether <= channels.rows; y += kTogether) passRows<kTogether>(channels, feedback_x, y);
  for (; y < channels.rows; ++y) passRows<1>(channels, feedback_x, y);
}

void passBetweenRows(const float* from, float* to, const float* a, int cols) {
  for (int x = 0; x < cols; ++x) {
    cv::v_store(to + 4 * x, blend(cv::v_load(to + 4 * x), cv::v_load(from + 4 * x), a[x]));
  }
}

}  // namespace

void filterAlongDepth(cv::Mat4f& channels, const cv::Mat1f& depth_m, float reach_cells) {
  const Coefficients a = coefficients(depth_m, reach_cells);
  const auto row = [&channels](int y) { return channels.ptr<float>(y); };
  for (int pass = 0; pass < kPasses; ++pass) {
    passAlongRows(channels, a.x);
    for (int y = 1; y < channels.rows; ++y) passBetweenRows(row(y - 1), row(y), a.y[y], channels.cols);
    for (int y = channels.rows - 2; y >= 0; --y) passBetweenRows(row(y + 1), row(y), a.y[y + 1], channels.cols);
  }
}

}  // namespace semantic_vslam
