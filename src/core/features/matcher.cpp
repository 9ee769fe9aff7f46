// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/features/matcher.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

namespace semantic_vslam {
namespace {

constexpr int kNoDistance = 257;

/// Two best distances seen so far.
struct BestTwo {
  int best = kNoDistance, second = kNoDistance;
  int index = -1, octave = -1, second_octave = -1;

  void offer(int distance, int candidate, int candidate_octave) {
    if (distance < best) {
      second = best;
      second_octave = octave;
      best = distance;
      index = candidate;
      octave = candidate_octave;
    } else if (distance < second) {
      second = distance;
      second_octave = candidate_octave;
    }
  }
};

bool depthAgrees(const GuidedQuery& query, const Feature& feature, float virtual_bf_px_m) {
  if (virtual_bf_px_m <= 0.0F || query.depth_m <= 0.0F || feature.depth_m <= 0.0F) return true;
  const float disparity_error_px = virtual_bf_px_m * std::abs(1.0F / query.depth_m - 1.0F / feature.depth_m);
  return disparity_error_px <= query.radius_px;
}

/// Keeps each feature's closest query.
void keepOnePerFeature(std::vector<FeatureMatch>& matches) {
  std::sort(matches.begin(), matches.end(), [](const FeatureMatch& a, const FeatureMatch& b) {
    return std::tie(a.feature, a.distance, a.query) < std::tie(b.feature, b.distance, b.query);
  });
  const auto same = [](const FeatureMatch& a, const FeatureMatch& b) { return a.feature == b.feature; };
  matches.erase(std::unique(matches.begin(), matches.end(), same), matches.end());
  std::sort(matches.begin(), matches.end(),
            [](const FeatureMatch& a, const FeatureMatch& b) { return a.query < b.query; });
}

/// A camera turns all features by the same angle: keeps the three fullest of 30 bins of rotation (Mur-Artal and Tardos
/// 2015, section V).
void keepConsistentRotation(std::vector<FeatureMatch>& matches, const std::vector<GuidedQuery>& queries,
                            const FrameFeatures& features) {
  constexpr int kBins = 30;
  const auto binOf = [&](const FeatureMatch& match) {
    const float query_angle = queries[match.query].angle_rad;
    if (std::isnan(query_angle)) return -1;
    const float turn = query_angle - features.features[match.feature].angle_rad;
    const float share = turn / static_cast<float>(2.0 * M_PI);
    return static_cast<int>((share - std::floor(share)) * kBins + 0.5F) % kBins;
  };
  std::array<int, kBins> counts{};
  for (const auto& match : matches) {
    if (const int bin = binOf(match); bin >= 0) ++counts[bin];
  }
  auto sorted = counts;
  std::sort(sorted.rbegin(), sorted.rend());
  // The second and third bin count only while they hold at least a tenth of the first: noise around the main turn.
  const double least = std::max(static_cast<double>(sorted[2]), 0.1 * sorted[0]);
  const auto odd = [&](const FeatureMatch& match) {
    const int bin = binOf(match);
    return bin >= 0 && counts[bin] < least;
  };
  matches.erase(std::remove_if(matches.begin(), matches.end(), odd), matches.end());
}

std::vector<BestTwo> nearest(const FrameFeatures& a, const std::vector<bool>& use_a, const FrameFeatures& b,
                             const std::vector<bool>& use_b) {
  std::vector<BestTwo> best(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!use_a.empty() && !use_a[i]) continue;
    const std::uint8_t* descriptor = a.descriptors.ptr(static_cast<int>(i));
    for (std::size_t j = 0; j < b.size(); ++j) {
      if (!use_b.empty() && !use_b[j]) continue;
      best[i].offer(descriptorDistance(descriptor, b.descriptors.ptr(static_cast<int>(j))), static_cast<int>(j), 0);
    }
  }
  return best;
}

}  // namespace

std::vector<FeatureMatch> searchGuided(const std::vector<GuidedQuery>& queries, const FrameFeatures& features,
                                       const FeatureGrid& grid, const std::vector<bool>& taken,
                                       const GuidedSearchConfig& config) {
  std::vector<FeatureMatch> matches;
  if (grid.empty()) return matches;
  bool any_angle = false;
  for (std::size_t q = 0; q < queries.size(); ++q) {
    const GuidedQuery& query = queries[q];
    BestTwo best;
    grid.visitNear(query.predicted_px, query.radius_px, query.min_octave, query.max_octave, [&](int index) {
      if (!taken.empty() && taken[index]) return;
      const Feature& feature = features.features[index];
      if (!depthAgrees(query, feature, config.virtual_bf_px_m)) return;
      best.offer(descriptorDistance(query.descriptor, features.descriptors.ptr(index)), index, feature.octave);
    });
    if (best.index < 0 || best.best > config.max_distance) continue;
    // A second candidate of another octave is mostly the same corner seen again, so it is no rival.
    const bool rival = best.second_octave == best.octave && best.second < kNoDistance;
    if (rival && static_cast<float>(best.best) > config.ratio * static_cast<float>(best.second)) continue;
    matches.push_back({static_cast<int>(q), best.index, best.best});
    any_angle = any_angle || !std::isnan(query.angle_rad);
  }
  keepOnePerFeature(matches);
  if (any_angle) keepConsistentRotation(matches, queries, features);
  return matches;
}

std::vector<FeatureMatch> matchBruteForce(const FrameFeatures& a, const std::vector<bool>& use_a,
                                          const FrameFeatures& b, const std::vector<bool>& use_b, int max_distance,
                                          float ratio) {
  const auto from_a = nearest(a, use_a, b, use_b);
  const auto from_b = nearest(b, use_b, a, use_a);
  std::vector<FeatureMatch> matches;
  for (std::size_t i = 0; i < from_a.size(); ++i) {
    const BestTwo& best = from_a[i];
    if (best.index < 0 || best.best > max_distance) continue;
    if (static_cast<float>(best.best) > ratio * static_cast<float>(best.second)) continue;
    if (from_b[best.index].index != static_cast<int>(i)) continue;
    matches.push_back({static_cast<int>(i), best.index, best.best});
  }
  return matches;
}

}  // namespace semantic_vslam
