// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "semantic_vslam/core/motion/label_memory.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace semantic_vslam {
namespace {

// Labels that vote: twice as many give half a per cent more overlap, at twice the cost (0.2 ms each).
constexpr std::size_t kMostViews = 6;
constexpr double kSpacingS = 0.5;  // nearer than this they repeat each other's errors
constexpr double kOldestS = 10.0;  // the odometry has drifted then
// Same surface: this near in depth, with what odometry drifts and with four standard deviations of the depth.
constexpr double kSameSurfaceM = 0.05, kDriftMetresPerSecond = 0.02;
constexpr float kMarginSigmas = 4.0F;
// Share of the votes that makes a person as likely as not: networks miss who sits behind a desk oftener than they see
// people in one, and a person in the map costs more than a desk that is missing for a while. From kSureShare on the
// votes count like those that nobody contradicts. What is seen to be at rest then has its say (addMasks).
constexpr float kLikelyShare = 1.0F / 3.0F, kSureShare = 0.6F;
constexpr float kNearestM = 0.1F;  // nearer than this to the earlier camera, nothing was seen

/// Depths to look surfaces up by: a hole (a black screen, a lamp) lies about where its farther edge does.
void surfaceDepths(const PlacedSurfaces& surfaces, int row, std::vector<float>& depth_m) {
  const float *measured = surfaces.depth_m[row], *around = surfaces.depth_high_m[row];
  for (std::size_t x = 0; x < depth_m.size(); ++x) depth_m[x] = measured[x] > 0.0F ? measured[x] : around[x];
}

/// @param share  of the votes, for a person
float belief(float share) {
  return std::clamp(0.5F + 0.5F * (share - kLikelyShare) / (kSureShare - kLikelyShare), 0.0F, 1.0F);
}

}  // namespace

cv::Mat1f LabelMemory::weigh(const cv::Mat1f& dynamic, const PlacedSurfaces& surfaces, const WorkGrid& grid) {
  while (!views_.empty() && secondsBetween(views_.front().surfaces.stamp, surfaces.stamp) > kOldestS) {
    views_.pop_front();
  }
  cv::Mat1f sum = dynamic.clone(), votes(sum.size(), 1.0F);
  std::vector<float> depth_m(sum.cols);
  ProjectedRow seen(sum.cols);
  for (const View& view : views_) {
    const PlacedSurfaces& earlier = view.surfaces;
    const double age_s = secondsBetween(earlier.stamp, surfaces.stamp);
    const auto margin_m = static_cast<float>(kSameSurfaceM + kDriftMetresPerSecond * age_s);
    const CellTransform T_earlier_now(earlier.T_odometry_camera.inverse() * surfaces.T_odometry_camera);
    for (int y = 0; y < sum.rows; ++y) {
      surfaceDepths(surfaces, y, depth_m);
      grid.projectRow(y, depth_m.data(), T_earlier_now, seen);
      const float* measured = surfaces.depth_m[y];
      for (int x = 0; x < sum.cols; ++x) {
        if (!(depth_m[x] > 0.0F && seen.depth_m[x] > kNearestM) || !grid.contains({seen.x[x], seen.y[x]})) continue;
        const cv::Point cell(static_cast<int>(seen.x[x] + 0.5F), static_cast<int>(seen.y[x] + 0.5F));
        const float then = earlier.depth_m(cell);
        const float sigma_m = surfaces.depth_sigma_at_1m_m * measured[x] * measured[x];
        const bool near_it = std::abs(then - seen.depth_m[x]) < margin_m + kMarginSigmas * sigma_m;
        if (measured[x] > 0.0F ? then <= 0.0F || !near_it : then > 0.0F) continue;
        sum(y, x) += view.dynamic(cell);
        votes(y, x) += 1.0F;
      }
    }
  }
  if (views_.empty() || secondsBetween(views_.back().surfaces.stamp, surfaces.stamp) >= kSpacingS) {
    views_.push_back({surfaces, dynamic});
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
