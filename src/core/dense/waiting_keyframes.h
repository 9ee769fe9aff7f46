// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <vector>

#include "core/dense/dense_mapper.h"
#include "semantic_vslam/core/geometry/timed_pose.h"

namespace semantic_vslam {

/// What the dense map takes of a keyframe, but for its pose; see DenseMapper::add().
struct DenseInput {
  KeyframeId id;
  RgbdFrame frame;
  cv::Mat1b labels, dynamic;
};

/// Keyframes whose place in the world is not known: those of a new map until it is joined with the old one. Knows no
/// thread.
class WaitingKeyframes {
 public:
  static constexpr std::size_t kMost = 32;  ///< 3.3 MB each at 640x480

  /// Adds one; place() is to follow.
  void add(DenseInput keyframe);
  /// Moves those that have a pose by now into the map, in the order they came; of more than kMost that have none the
  /// oldest go.
  void place(const std::vector<KeyframePose>& poses, DenseMapper& map);
  /// Drops those that nobody will place any more.
  void keepOnly(const std::function<bool(KeyframeId)>& wanted);
  void clear() { waiting_.clear(); }
  std::size_t size() const { return waiting_.size(); }

 private:
  std::deque<DenseInput> waiting_;
};

}  // namespace semantic_vslam
