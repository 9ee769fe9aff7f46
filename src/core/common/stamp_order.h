// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "semantic_vslam/core/common/stamp.h"

namespace semantic_vslam {

/// The one rule for stamps that do not grow.
class StampOrder {
 public:
  enum class Arrival {
    kNext,        ///< newer than all before
    kLate,        ///< not newer, by little: to be passed over
    kSetBack,     ///< older by far: the clock of a living camera was set back, the stamps to come are those again
    kPlayedAgain  ///< a recording begins, for the first or the second time
  };

  /// A driver's clock or the network may put frames out of order by less than this. Drivers step back by more where
  /// their device's counter wraps (librealsense's global time, every 72 minutes).
  static constexpr double kLongestDisorderS = 5.0;

  /// @param recording  changes when the caller knows that a recording begins again (a simulated clock went back)
  Arrival of(Stamp stamp, std::uint32_t recording) {
    Arrival arrival = Arrival::kNext;
    if (newest_ && recording != recording_) {
      arrival = Arrival::kPlayedAgain;
    } else if (newest_ && stamp <= *newest_) {
      arrival = secondsBetween(stamp, *newest_) <= kLongestDisorderS ? Arrival::kLate : Arrival::kSetBack;
    }
    if (arrival != Arrival::kLate) newest_ = stamp;
    recording_ = recording;
    return arrival;
  }

 private:
  std::optional<Stamp> newest_;
  std::uint32_t recording_ = 0;
};

}  // namespace semantic_vslam
