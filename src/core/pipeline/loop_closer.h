// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/common/abort_flag.h"
#include "core/loop/loop_detector.h"
#include "core/pipeline/sparse_state.h"
#include "semantic_vslam/core/common/stamp.h"
#include "semantic_vslam/core/pipeline/config.h"

namespace semantic_vslam {

/// A loop that was closed, as the place was recognised.
struct ClosedLoop {
  Stamp current, matched;                   ///< of the keyframe that came back, and of the earlier one it saw again
  SE3 T_current_matched = SE3::Identity();  ///< as the old landmarks had it, before any optimisation
};

/// Closes loops in a map that tracking may work on meanwhile: looks and copies alone with the map, solves, applies
/// alone with it again (Mur-Artal and Tardos 2015, section VII).
class LoopCloser {
 public:
  /// @param state  must outlive this object  @throws ConfigError
  LoopCloser(const SparseSlamConfig& config, SparseState& state);

  /// Looks whether the camera is back at an old place, and if so bends the map to that; joins the trees of both visits
  /// if they are two. adjustAll() should follow.
  /// @return whether a loop was closed
  bool closeAt(KeyframeId keyframe, const Alone& alone);
  /// See LoopDetector. For each new keyframe, before closeAt(), alone with the map.
  void noteKeyframe(KeyframeId id, double found_share) { detector_.noteKeyframe(id, found_share); }
  /// Global bundle adjustment. @param abort  ends it early, with nothing changed
  void adjustAll(const Alone& alone, const AbortFlag& abort);

  /// Every loop closed in this map, in order.
  const std::vector<ClosedLoop>& closedLoops() const { return closed_; }
  /// The map is another one.
  void reset();

 private:
  /// Bends the map to a closure. @return false if the map changed while that was computed, or lost its keyframes
  bool correct(const LoopClosure& closure, const Alone& alone);

  const SparseSlamConfig config_;
  SparseState& state_;
  LoopDetector detector_;
  std::vector<ClosedLoop> closed_;
};

}  // namespace semantic_vslam
