// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/features/frame_features.h"

namespace semantic_vslam {

/// Index of a frame's features by undistorted position, in square cells.
class FeatureGrid {
 public:
  FeatureGrid() = default;
  /// @param width, height  image size in px; features outside (undistortion can push them there) go to the border cells
  FeatureGrid(const FrameFeatures& features, int width, int height);

  /// Calls visit(index) for every feature within radius_px (square) of centre_px whose octave is in range.
  template <class Visit>
  void visitNear(const Eigen::Vector2f& centre_px, float radius_px, int min_octave, int max_octave,
                 const Visit& visit) const {
    const int left = columnOf(centre_px.x() - radius_px), right = columnOf(centre_px.x() + radius_px);
    const int top = rowOf(centre_px.y() - radius_px), bottom = rowOf(centre_px.y() + radius_px);
    for (int row = top; row <= bottom; ++row) {
      for (int i = starts_[row * columns_ + left]; i < starts_[row * columns_ + right + 1]; ++i) {
        const Entry& entry = entries_[i];
        if (entry.octave < min_octave || entry.octave > max_octave) continue;
        if (std::abs(entry.px.x() - centre_px.x()) > radius_px) continue;
        if (std::abs(entry.px.y() - centre_px.y()) > radius_px) continue;
        visit(entry.index);
      }
    }
  }
  bool empty() const { return entries_.empty(); }

 private:
  static constexpr float kCellPx = 16.0F;
  struct Entry {
    Eigen::Vector2f px;
    int octave = 0;
    int index = 0;
  };
  int columnOf(float x) const { return std::clamp(static_cast<int>(x / kCellPx), 0, columns_ - 1); }
  int rowOf(float y) const { return std::clamp(static_cast<int>(y / kCellPx), 0, rows_ - 1); }

  int columns_ = 1, rows_ = 1;
  std::vector<Entry> entries_;        // sorted by cell
  std::vector<int> starts_ = {0, 0};  // first entry of each cell, and the end
};

}  // namespace semantic_vslam
