// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "semantic_vslam/core/motion/depth_vote.h"

#include <algorithm>
#include <cmath>
#include <optional>

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

/// The cell of the reference that a surface of the present frame falls on, and its depth there.
struct SeenBefore {
  cv::Point cell;
  float depth_m;
};

std::optional<SeenBefore> lookUp(const WorkGrid& grid, const CellTransform& T_reference_current, const cv::Vec2f& ray,
                                 float depth_m) {
  const cv::Point3f point = T_reference_current.at(T_reference_current.turn(ray), depth_m);
  if (point.z < kNearestM) return std::nullopt;
  const cv::Point2f seen = grid.project(point.x, point.y, point.z);
  if (!grid.contains(seen)) return std::nullopt;
  return SeenBefore{{static_cast<int>(seen.x + 0.5F), static_cast<int>(seen.y + 0.5F)}, point.z};
}

}  // namespace

DepthVote voteByDepth(const GridFrame& current, const DepthReference& reference, const WorkGrid& grid,
                      const RigidFlowConfig& config) {
  DepthVote vote{cv::Mat1f(grid.size(), 0.0F), cv::Mat1f(grid.size(), 0.0F)};
  const CellTransform T_reference_current(reference.T_reference_current);
  const auto age_s = static_cast<float>(secondsBetween(reference.stamp, current.stamp));
  const float base_margin_m = static_cast<float>(config.min_depth_margin_m) + kDriftMetresPerSecond * age_s;
  for (int y = 0; y < grid.size().height; ++y) {
    const float *depth_row = current.depth_m[y], *behind_row = current.depth_high_m[y];
    const cv::Vec2f* rays = grid.rays()[y];
    float *entered = vote.entered[y], *stayed = vote.stayed[y];
    for (int x = 0; x < grid.size().width; ++x) {
      const bool hole = depth_row[x] <= 0.0F;
      const float z = hole ? behind_row[x] : depth_row[x];
      if (z <= 0.0F) continue;
      const auto seen = lookUp(grid, T_reference_current, rays[x], z);
      if (!seen) continue;
      const float measured = reference.depth_m(seen->cell);
      if (hole || measured <= 0.0F) {
        // A hole where there was a hole (a black screen, a lamp) tells little, but of something that stands still.
        if (hole && measured <= 0.0F) {
          stayed[x] = kHoleStayed * (1.0F - reference.dynamic_probability(seen->cell));
        }
        continue;
      }
      const float margin = base_margin_m + kMarginSigmas * depthSigma(config, std::max(z, measured));
      const float gap = reference.depth_low_m(seen->cell) - seen->depth_m;
      if (gap > margin) {
        entered[x] = std::min(1.0F, (gap - margin) / margin);
      } else if (std::abs(measured - seen->depth_m) < margin) {
        stayed[x] = 1.0F - reference.dynamic_probability(seen->cell);
      }
    }
  }
  return vote;
}

}  // namespace semantic_vslam
