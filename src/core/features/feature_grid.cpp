// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/features/feature_grid.h"

namespace semantic_vslam {

FeatureGrid::FeatureGrid(const FrameFeatures& features, int width, int height)
    : columns_(std::max(1, static_cast<int>(std::ceil(static_cast<float>(width) / kCellPx)))),
      rows_(std::max(1, static_cast<int>(std::ceil(static_cast<float>(height) / kCellPx)))) {
  const auto cellOf = [this](const Feature& feature) {
    return rowOf(feature.undistorted_px.y()) * columns_ + columnOf(feature.undistorted_px.x());
  };
  starts_.assign(static_cast<std::size_t>(columns_) * rows_ + 1, 0);
  for (const Feature& feature : features.features) ++starts_[cellOf(feature) + 1];
  for (std::size_t i = 1; i < starts_.size(); ++i) starts_[i] += starts_[i - 1];
  entries_.resize(features.size());
  std::vector<int> next(starts_.begin(), starts_.end() - 1);
  for (std::size_t i = 0; i < features.size(); ++i) {
    const Feature& feature = features.features[i];
    entries_[next[cellOf(feature)]++] = {feature.undistorted_px, feature.octave, static_cast<int>(i)};
  }
}

}  // namespace semantic_vslam
