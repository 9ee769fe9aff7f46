// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <iterator>
#include <string>
#include <vector>

namespace semantic_vslam {

/// Lets a message pass that is news: one that was not said within half a minute, or that stayed away for half a second
/// while another one was said. So several faults that take turns are said once each, and one that comes back is said
/// again. By the steady clock: simulated time, which ROS_WARN_THROTTLE goes by, stands still just when an input is
/// missing. One thread.
class LogThrottle {
 public:
  /// @param message  "" says that all is well: what comes after it is news again
  bool passes(const std::string& message) {
    if (message.empty()) messages_.clear();
    if (message.empty()) return false;
    const Clock::time_point now = Clock::now();
    const auto known =
        std::find_if(messages_.begin(), messages_.end(), [&](const auto& m) { return m.text == message; });
    if (known == messages_.end()) {
      if (messages_.size() == kMost) messages_.erase(messages_.begin());
    } else {
      const bool is_last = std::next(known) == messages_.end();
      const bool came_back = !is_last && now - known->seen >= kAway;
      known->seen = now;
      if (!came_back && now - known->said < kSilence) return false;
      messages_.erase(known);
    }
    messages_.push_back({message, now, now});
    return true;
  }

 private:
  using Clock = std::chrono::steady_clock;
  struct Message {
    std::string text;
    Clock::time_point said, seen;
  };
  static constexpr std::chrono::milliseconds kSilence{30000}, kAway{500};
  static constexpr std::size_t kMost = 20;  // messages that are remembered
  std::vector<Message> messages_;           // in the order in which they were said
};

}  // namespace semantic_vslam
