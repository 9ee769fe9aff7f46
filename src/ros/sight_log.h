// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "semantic_vslam/core/common/log.h"
#include "semantic_vslam/core/common/stamp.h"
#include "semantic_vslam/core/pipeline/messages.h"

namespace semantic_vslam {

/// What is worth a line in the log when the camera loses its place in the map and finds it again: one line each,
/// however many frames it takes, and no more where the state flickers. One thread.
class SightLog {
 public:
  struct Line {
    LogLevel level;
    std::string text;
  };

  /// @param stamp, output  of each frame that was tracked, in order
  std::optional<Line> next(Stamp stamp, const TrackingOutput& output);

 private:
  std::optional<Line> lost(Stamp stamp, const TrackingOutput& output);
  std::optional<Line> found(Stamp stamp, const TrackingOutput& output);

  std::optional<std::uint32_t> map_id_;
  bool ok_in_map_ = false;      ///< a frame of this map had a pose
  std::optional<Stamp> since_;  ///< first frame without a place in the map
  bool said_ = false;           ///< that it is lost
  bool map_begun_ = false;      ///< a new map, while lost
  std::optional<Stamp> last_line_;
};

}  // namespace semantic_vslam
