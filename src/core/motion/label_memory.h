// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <opencv2/core.hpp>

#include "core/motion/place_lookup.h"

namespace semantic_vslam {

/// Weighs a frame's labels against what those of the last seconds said of the same surfaces, found by their position in
/// space. A network that calls a desk a person now and then is outvoted, also after somebody has walked in front of it;
/// who walks is nowhere seen before and believed at once.
class LabelMemory {
 public:
  void clear() { views_.clear(); }
  /// Remembers the labels as they came.
  /// @param dynamic  what the labels say, 0 .. 1, grid size
  /// @return what all of them say of each surface together, 0 .. 1; 0.5 where a third of them sees a person
  cv::Mat1f weigh(const cv::Mat1f& dynamic, const PlacedFrame& place, const WorkGrid& grid,
                  const RigidFlowConfig& config);

 private:
  struct View {
    PlacedFrame place;
    cv::Mat1f dynamic;
  };

  std::deque<View> views_;  // oldest first
};

}  // namespace semantic_vslam
