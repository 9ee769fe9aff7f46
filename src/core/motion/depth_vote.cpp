// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "semantic_vslam/core/motion/depth_vote.h"

#include "semantic_vslam/core/motion/camera_motion.h"

namespace semantic_vslam {
namespace {

// Noise of both depths together that is tolerated, in standard deviations of one.
constexpr float kMarginSigmas = 4.0F;
// Error that chained frame-to-frame motions gather, metres per second.
constexpr float kDriftMetresPerSecond = 0.02F;

void voteAgainst(const GridFrame& current, const DepthReference& reference, const WorkGrid& grid,
                 const RigidFlowConfig& config, DepthVote& vote) {
  const Eigen::Matrix3f R = reference.T_reference_current.linear().cast<float>();
  const Eigen::Vector3f t = reference.T_reference_current.translation().cast<float>();
  const auto age_s = static_cast<float>(secondsBetween(reference.stamp, current.stamp));
  const float base_margin_m = static_cast<float>(config.min_depth_margin_m) + kDriftMetresPerSecond * age_s;
  const cv::Size size = grid.size();
  for (int y = 0; y < size.height; ++y) {
    const float* depth_row = current.depth_m[y];
    for (int x = 0; x < size.width; ++x) {
      const float z = depth_row[x];
      if (z <= 0.0F) continue;
      const cv::Vec2f ray = grid.rays()(y, x);
      const Eigen::Vector3f point = R * (Eigen::Vector3f(ray[0], ray[1], 1.0F) * z) + t;
      if (point.z() < 0.1F) continue;
      const cv::Point2f seen = grid.project(point);
      if (!grid.contains(seen)) continue;
      const cv::Point cell(static_cast<int>(seen.x + 0.5F), static_cast<int>(seen.y + 0.5F));
      const float measured = reference.depth_m(cell);
      if (measured <= 0.0F) continue;
      const float margin = base_margin_m + kMarginSigmas * depthSigma(config, std::max(z, measured));
      const float gap = reference.depth_low_m(cell) - point.z();
      if (gap > margin) {
        vote.entered(y, x) = std::max(vote.entered(y, x), std::min(1.0F, (gap - margin) / margin));
        vote.stayed(y, x) = 0.0F;
      } else if (std::abs(measured - point.z()) < margin) {
        vote.stayed(y, x) = 1.0F - reference.dynamic_probability(cell);
      }
    }
  }
}

}  // namespace

DepthVote voteByDepth(const GridFrame& current, const std::deque<DepthReference>& references, const WorkGrid& grid,
                      const RigidFlowConfig& config) {
  DepthVote vote{cv::Mat1f(grid.size(), 0.0F), cv::Mat1f(grid.size(), 0.0F)};
  // From the newest to the oldest, so that the oldest that tells has the last word on what stayed.
  for (auto reference = references.rbegin(); reference != references.rend(); ++reference) {
    voteAgainst(current, *reference, grid, config, vote);
  }
  return vote;
}

}  // namespace semantic_vslam
