// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "core/map/tracked_frame.h"
#include "core/tracking/frame_tracker.h"
#include "semantic_vslam/core/tracking/tracking_config.h"

namespace semantic_vslam {

/// Initialisation in a dynamic scene: frame k1 comes with its people's points removed (its dynamic mask holds the
/// people that segmentation found); k2 is matched to it. If the conditions are not met k1 is released and k2 becomes
/// k1.
class Initializer {
 public:
  /// @throws ConfigError
  Initializer(const InitializerConfig& config, const FrameTrackerConfig& tracker);

  /// @param frame  k1 or k2; as k2 of a success it gets its pose relative to k1
  /// @return k1, at the origin, if `frame` completes a pair that meets the conditions
  std::optional<TrackedFrame> offer(TrackedFrame& frame);
  void reset() { first_.reset(); }

 private:
  bool isUsable(const TrackedFrame& frame) const;

  InitializerConfig config_;
  FrameTrackerConfig tracker_;
  std::optional<TrackedFrame> first_;
};

}  // namespace semantic_vslam
