// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <opencv2/core.hpp>

#include "semantic_vslam/core/geometry/se3.h"
#include "semantic_vslam/core/motion/work_grid.h"

namespace semantic_vslam {

/// A frame's surfaces in space.
struct PlacedSurfaces {
  Stamp stamp;
  cv::Mat1f depth_m;       ///< grid size; 0 = hole
  cv::Mat1f depth_high_m;  ///< GridFrame's; in holes, farthest of their surroundings
  SE3 T_odometry_camera = SE3::Identity();
  float depth_sigma_at_1m_m = 0.003F;  ///< grows with the square of depth
};

/// Weighs a frame's labels against what those of the last seconds said of the same surfaces, found by their position in
/// space. A network that calls a desk a person now and then is outvoted, also after somebody has walked in front of it;
/// who walks is nowhere seen before and believed at once.
class LabelMemory {
 public:
  void clear() { views_.clear(); }
  /// Remembers the labels as they came.
  /// @param dynamic  what the labels say, 0 .. 1, grid size
  /// @return what all of them say of each surface together, 0 .. 1; 0.5 where a third of them sees a person
  cv::Mat1f weigh(const cv::Mat1f& dynamic, const PlacedSurfaces& surfaces, const WorkGrid& grid);

 private:
  struct View {
    PlacedSurfaces surfaces;
    cv::Mat1f dynamic;
  };

  std::deque<View> views_;  // oldest first
};

}  // namespace semantic_vslam
