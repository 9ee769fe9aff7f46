// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "semantic_vslam/core/motion/depth_vote.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "semantic_vslam/core/motion/camera_motion.h"

namespace semantic_vslam {
namespace {

// Noise of both depths together that is tolerated, in standard deviations of one.
constexpr float kMarginSigmas = 4.0F;
constexpr float kNearestM = 0.1F;  // nearer than this to the earlier camera, nothing was seen
// What a hole that stays a hole counts, against a surface that stays.
constexpr float kHoleStayed = 0.5F;
// Error that chained frame-to-frame motions gather, metres per second.
constexpr float kDriftMetresPerSecond = 0.02F;

}  // namespace

DepthVote voteByDepth(const GridFrame& current, const DepthReference& reference, const WorkGrid& grid,
                      const RigidFlowConfig& config) {
  DepthVote vote{cv::Mat1f(grid.size(), 0.0F), cv::Mat1f(grid.size(), 0.0F)};
  const CellTransform T_reference_current(reference.T_reference_current);
  const auto age_s = static_cast<float>(secondsBetween(reference.stamp, current.stamp));
  const float base_margin_m = static_cast<float>(config.min_depth_margin_m) + kDriftMetresPerSecond * age_s;
  std::vector<float> surface_m(grid.size().width);
  ProjectedRow seen(grid.size().width);
  for (int y = 0; y < grid.size().height; ++y) {
    const float *depth_row = current.depth_m[y], *behind_row = current.depth_high_m[y];
    for (int x = 0; x < grid.size().width; ++x) surface_m[x] = depth_row[x] > 0.0F ? depth_row[x] : behind_row[x];
    grid.projectRow(y, surface_m.data(), T_reference_current, seen);
    float *entered = vote.entered[y], *stayed = vote.stayed[y];
    for (int x = 0; x < grid.size().width; ++x) {
      const bool visible = surface_m[x] > 0.0F && seen.depth_m[x] >= kNearestM;
      if (!visible || !grid.contains({seen.x[x], seen.y[x]})) continue;
      const cv::Point cell(static_cast<int>(seen.x[x] + 0.5F), static_cast<int>(seen.y[x] + 0.5F));
      const bool hole = depth_row[x] <= 0.0F;
      const float measured = reference.depth_m(cell);
      if (hole || measured <= 0.0F) {
        // A hole where there was a hole (a black screen, a lamp) tells little, but of something that stands still.
        if (hole && measured <= 0.0F) stayed[x] = kHoleStayed * (1.0F - reference.dynamic_probability(cell));
        continue;
      }
      const float margin = base_margin_m + kMarginSigmas * depthSigma(config, std::max(surface_m[x], measured));
      const float gap = reference.depth_low_m(cell) - seen.depth_m[x];
      if (gap > margin) {
        entered[x] = std::min(1.0F, (gap - margin) / margin);
      } else if (std::abs(measured - seen.depth_m[x]) < margin) {
        stayed[x] = 1.0F - reference.dynamic_probability(cell);
      }
    }
  }
  return vote;
}

}  // namespace semantic_vslam
