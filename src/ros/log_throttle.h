// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace semantic_vslam {

/// Lets a message pass that was not said within half a minute: several faults at once take turns, and each is said. By
/// the steady clock: simulated time, which ROS_WARN_THROTTLE goes by, stands still just when an input is missing. One
/// thread.
class LogThrottle {
 public:
  /// @param message  "" says that all is well: what comes after it is news again
  bool passes(const std::string& message) {
    const Clock::time_point now = Clock::now();
    const auto is_old = [&](const auto& said) { return message.empty() || now - said.second >= kSilence; };
    said_.erase(std::remove_if(said_.begin(), said_.end(), is_old), said_.end());
    const auto same = [&](const auto& said) { return said.first == message; };
    if (message.empty() || std::any_of(said_.begin(), said_.end(), same)) return false;
    if (said_.size() == kMost) said_.erase(said_.begin());
    said_.emplace_back(message, now);
    return true;
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::seconds kSilence{30};
  static constexpr std::size_t kMost = 20;  // messages that are remembered
  std::vector<std::pair<std::string, Clock::time_point>> said_;
};

}  // namespace semantic_vslam
