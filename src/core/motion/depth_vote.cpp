// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/motion/depth_vote.h"

#include <algorithm>

namespace semantic_vslam {
namespace {

// What a hole that stays a hole counts, against a surface that stays: it tells little, but of something that stands
// still.
constexpr float kHoleStayed = 0.5F;

}  // namespace

DepthVote voteByDepth(const PlacedFrame& current, const DepthReference& reference, const WorkGrid& grid,
                      const RigidFlowConfig& config, cv::Range rows_in_turn) {
  DepthVote vote{cv::Mat1f(grid.size(), 0.0F), cv::Mat1f(grid.size(), 0.0F)};
  PlaceLookup lookup(current, reference.place, grid, config);
  for (int y = rows_in_turn.start; y < grid.size().height; y += rows_in_turn.end) {
    float *entered = vote.entered[y], *stayed = vote.stayed[y];
    lookup.row(y, [&](int x, const PlaceLookup::Sighting& seen) {
      if (seen.same()) {
        const float moved = reference.dynamic_probability(seen.cell);
        if (moved < 0.5F) stayed[x] = (seen.hole ? kHoleStayed : 1.0F) * (1.0F - moved);
      } else if (!seen.hole && seen.measured_m > 0.0F) {
        const float gap_m = reference.depth_low_m(seen.cell) - seen.depth_m;
        if (gap_m > seen.margin_m) entered[x] = std::min(1.0F, (gap_m - seen.margin_m) / seen.margin_m);
      }
    });
  }
  return vote;
}

}  // namespace semantic_vslam
