// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/motion/surface_evidence.h"

#include <cmath>
#include <limits>

#include "core/motion/edge_aware_filter.h"

namespace semantic_vslam {
namespace {

constexpr float kReachCells = 6.0F;
constexpr float kHoleWeight = 0.3F;
// Least share of a surface nearby that a mask must speak of to count for all of it.
constexpr float kLeastKnown = 0.2F;

/// Channels of the filter: evidence, its weight, mask, its weight.
cv::Mat4f toChannels(const cv::Mat1f& log_odds, const cv::Mat1f& semantic, const cv::Mat1f& depth_m) {
  cv::Mat4f channels(depth_m.size());
  for (int y = 0; y < depth_m.rows; ++y) {
    const float* depth = depth_m[y];
    const float* odds = log_odds.empty() ? nullptr : log_odds[y];
    const float* mask = semantic.empty() ? nullptr : semantic[y];
    cv::Vec4f* out = channels[y];
    for (int x = 0; x < depth_m.cols; ++x) {
      const float weight = depth[x] > 0.0F ? 1.0F : kHoleWeight;
      const bool known = mask != nullptr && !std::isnan(mask[x]);
      out[x] = {odds != nullptr ? weight * odds[x] : 0.0F, weight, known ? weight * mask[x] : 0.0F,
                known ? weight : 0.0F};
    }
  }
  return channels;
}

}  // namespace

SurfaceEvidence shareAlongSurfaces(const cv::Mat1f& log_odds, const cv::Mat1f& semantic, const cv::Mat1f& depth_m) {
  SurfaceEvidence evidence;
  if (log_odds.empty() && semantic.empty()) return evidence;
  cv::Mat4f channels = toChannels(log_odds, semantic, depth_m);
  filterAlongDepth(channels, depth_m, kReachCells);
  if (!log_odds.empty()) evidence.log_odds.create(depth_m.size());
  if (!semantic.empty()) evidence.semantic.create(depth_m.size());
  for (int y = 0; y < depth_m.rows; ++y) {
    const cv::Vec4f* mean = channels[y];
    float* odds = log_odds.empty() ? nullptr : evidence.log_odds[y];
    float* mask = semantic.empty() ? nullptr : evidence.semantic[y];
    for (int x = 0; x < depth_m.cols; ++x) {
      if (odds != nullptr) odds[x] = mean[x][0] / mean[x][1];
      if (mask == nullptr) continue;
      const bool known = mean[x][3] > kLeastKnown * mean[x][1];
      mask[x] = known ? mean[x][2] / mean[x][3] : std::numeric_limits<float>::quiet_NaN();
    }
  }
  return evidence;
}

}  // namespace semantic_vslam
