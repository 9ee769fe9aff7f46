// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/motion/label_memory.h"

#include <algorithm>

namespace semantic_vslam {
namespace {

// Labels that vote: twice as many give half a per cent more overlap, at twice the cost (0.2 ms each).
constexpr std::size_t kMostViews = 6;
constexpr double kSpacingS = 0.5;  // nearer than this they repeat each other's errors
constexpr double kOldestS = 10.0;  // the odometry has drifted then
// Share of the votes that makes a person as likely as not: networks miss who sits behind a desk oftener than they see
// people in one, and a person in the map costs more than a desk that is missing for a while. From kSureShare on the
// votes count like those that nobody contradicts. What is seen to be at rest then has its say (addMasks).
constexpr float kLikelyShare = 1.0F / 3.0F, kSureShare = 0.6F;

/// @param share  of the votes, for a person
float belief(float share) {
  return std::clamp(0.5F + 0.5F * (share - kLikelyShare) / (kSureShare - kLikelyShare), 0.0F, 1.0F);
}

}  // namespace

cv::Mat1f LabelMemory::weigh(const cv::Mat1f& dynamic, const PlacedFrame& place, const WorkGrid& grid,
                             const RigidFlowConfig& config) {
  while (!views_.empty() && secondsBetween(views_.front().place.stamp, place.stamp) > kOldestS) views_.pop_front();
  cv::Mat1f sum = dynamic.clone(), votes(sum.size(), 1.0F);
  for (const View& view : views_) {
    PlaceLookup lookup(place, view.place, grid, config);
    for (int y = 0; y < sum.rows; ++y) {
      lookup.row(y, [&, sum_row = sum[y], votes_row = votes[y]](int x, const PlaceLookup::Sighting& seen) {
        if (!seen.same()) return;
        sum_row[x] += view.dynamic(seen.cell);
        votes_row[x] += 1.0F;
      });
    }
  }
  if (views_.empty() || secondsBetween(views_.back().place.stamp, place.stamp) >= kSpacingS) {
    views_.push_back({place, dynamic});
    if (views_.size() > kMostViews) views_.pop_front();
  }
  for (int y = 0; y < sum.rows; ++y) {
    for (int x = 0; x < sum.cols; ++x) {
      if (votes(y, x) > 1.0F) sum(y, x) = belief(sum(y, x) / votes(y, x));
    }
  }
  return sum;
}

}  // namespace semantic_vslam
