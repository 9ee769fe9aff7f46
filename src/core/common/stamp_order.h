// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include "semantic_vslam/core/common/stamp.h"

namespace semantic_vslam {

/// The one rule for stamps that do not follow those before them. One frame may be stamped wrongly, or come late;
/// several that agree among themselves tell where the clock stands now.
class StampOrder {
 public:
  enum class Arrival {
    kNext,        ///< follows those before it
    kOutOfOrder,  ///< does not, and too few say the same: to be passed over
    kSetBack,  ///< the clock of a living camera was set back, or its recording begins again unsaid: so are the stamps
    kPlayedAgain  ///< a recording is known to begin again
  };

  /// A frame that is newer by more than this has to be confirmed, unless frames are as rare as that. One stamp in the
  /// future, used, would end tf for all who listen: their buffers refuse what is older by 10 s. To skip some frames
  /// after a real pause costs less.
  static constexpr double kLongestStepS = 5.0;
  /// Frames in a row, each newer than the one before, that are believed against all before them. A network or a driver
  /// that swaps frames swaps one or two.
  static constexpr int kAgreeing = 3;

  /// @param recording  changes when the caller knows that a recording begins again (a simulated clock went back)
  Arrival of(Stamp stamp, std::uint32_t recording) {
    const bool played_again = newest_ && recording != recording_;
    recording_ = recording;
    if (!newest_ || played_again) return take(stamp, 0.0, played_again ? Arrival::kPlayedAgain : Arrival::kNext);
    if (follows(*newest_, stamp, step_s_)) return take(stamp, secondsBetween(*newest_, stamp), Arrival::kNext);
    // The second one tells how far apart they are, the third must fit.
    const bool agrees = straying_ == 1 ? stamp > stray_ : straying_ > 1 && follows(stray_, stamp, stray_step_s_);
    straying_ = agrees ? straying_ + 1 : 1;
    stray_step_s_ = secondsBetween(stray_, stamp);
    stray_ = stamp;
    if (straying_ < kAgreeing) return Arrival::kOutOfOrder;
    return take(stamp, stray_step_s_, stamp > *newest_ ? Arrival::kNext : Arrival::kSetBack);
  }

 private:
  static bool follows(Stamp before, Stamp stamp, double usual_step_s) {
    return stamp > before && secondsBetween(before, stamp) <= std::max(kLongestStepS, 2.0 * usual_step_s);
  }
  Arrival take(Stamp stamp, double step_s, Arrival arrival) {
    newest_ = stamp;
    step_s_ = step_s;
    straying_ = 0;
    return arrival;
  }

  std::optional<Stamp> newest_;  ///< that was taken
  double step_s_ = 0.0;          ///< to it
  int straying_ = 0;             ///< last ones in a row that do not follow the newest, but each other
  Stamp stray_;                  ///< last of them
  double stray_step_s_ = 0.0;    ///< to it
  std::uint32_t recording_ = 0;
};

}  // namespace semantic_vslam
