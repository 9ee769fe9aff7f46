// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

#include "core/features/feature_grid.h"
#include "core/features/frame_features.h"

namespace semantic_vslam {

// Of 256 bits. Unrelated ORB descriptors differ by 128 +- 8 bits or more; the same point under tracking by 20-60
// (Rublee et al. 2011, figure 9). Strict where the position is not known in advance.
constexpr int kMaxDistanceGuided = 100;
constexpr int kMaxDistanceStrict = 50;

struct FeatureMatch {
  int query = 0;    ///< index of the query (or of the feature in the first frame)
  int feature = 0;  ///< index of the feature in the (second) frame
  int distance = 0;
};

/// Something to be found near a predicted position.
struct GuidedQuery {
  const std::uint8_t* descriptor = nullptr;  ///< 32 bytes, not owned
  Eigen::Vector2f predicted_px;              ///< undistorted
  float radius_px = 0.0F;
  int min_octave = 0, max_octave = kPyramidLevels - 1;
  float depth_m = 0.0F;                                       ///< expected; 0 = not compared
  float angle_rad = std::numeric_limits<float>::quiet_NaN();  ///< of the earlier sighting; NaN = not compared
};

struct GuidedSearchConfig {
  int max_distance = kMaxDistanceGuided;
  /// The best must beat the second best of the same octave by this ratio; 1 = not asked.
  float ratio = 1.0F;
  /// fx * virtual baseline, px m: depth is compared as virtual disparity, within the search radius; 0 = not compared.
  float virtual_bf_px_m = 0.0F;
};

/// Finds each query's best feature near its predicted position; every feature is given at most once (the closest
/// descriptor wins). Matches whose rotation disagrees with the majority are dropped where queries carry an angle.
/// @param taken  features that are not to be used, may be empty
std::vector<FeatureMatch> searchGuided(const std::vector<GuidedQuery>& queries, const FrameFeatures& features,
                                       const FeatureGrid& grid, const std::vector<bool>& taken,
                                       const GuidedSearchConfig& config);

/// Mutual nearest neighbours with the ratio test, without any prediction of position.
/// @param use_a, use_b  features that may match; empty = all
std::vector<FeatureMatch> matchBruteForce(const FrameFeatures& a, const std::vector<bool>& use_a,
                                          const FrameFeatures& b, const std::vector<bool>& use_b, int max_distance,
                                          float ratio);

}  // namespace semantic_vslam
