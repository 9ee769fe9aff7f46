// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstddef>
#include <vector>

#include "core/loop/loop_detector.h"
#include "core/pipeline/shared_map.h"
#include "semantic_vslam/core/common/stamp.h"
#include "semantic_vslam/core/pipeline/sparse_slam_config.h"

namespace semantic_vslam {

/// A loop that was closed, as the place was recognised.
struct ClosedLoop {
  Stamp current, matched;                   ///< of the keyframe that came back, and of the earlier one it saw again
  SE3 T_current_matched = SE3::Identity();  ///< as the old landmarks had it, before any optimisation
};

/// Closes loops in a map that tracking works on meanwhile: looks, copies, solves without the lock, applies (Mur-Artal
/// and Tardos 2015, section VII).
class LoopCloser {
 public:
  /// @param map  must outlive this object  @throws ConfigError
  LoopCloser(const SparseSlamConfig& config, SharedMap& map);

  /// Looks whether the camera is back at an old place, and if so bends the map to that; joins the trees of both visits
  /// if they are two. adjustAll() should follow.
  /// @return whether a loop was closed
  bool closeAt(KeyframeId keyframe);
  /// Global bundle adjustment. @param abort  ends it early, with nothing changed
  void adjustAll(const std::atomic<bool>& abort);

  /// Every loop closed in this map, in order.
  std::vector<ClosedLoop> closedLoops() const;
  std::size_t count() const;
  /// The map is another one; the caller holds its mutex.
  void resetLocked();

 private:
  /// Bends the map to a closure. @return false if the map changed while that was computed, or lost its keyframes
  bool correct(const LoopClosure& closure);

  const SparseSlamConfig config_;
  SharedMap& shared_;
  LoopDetector detector_;           // guarded by shared_.mutex
  std::vector<ClosedLoop> closed_;  // guarded by shared_.mutex
};

}  // namespace semantic_vslam
