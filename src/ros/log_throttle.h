// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <string>

namespace semantic_vslam {

/// Lets a message pass when it differs from the last one, or that one is old. By the steady clock: simulated time,
/// which ROS_WARN_THROTTLE goes by, stands still just when an input is missing. One thread.
class LogThrottle {
 public:
  bool passes(const std::string& message) {
    const Clock::time_point now = Clock::now();
    if (message == last_ && now - said_ < std::chrono::seconds(30)) return false;
    last_ = message;
    said_ = now;
    return !message.empty();
  }

 private:
  using Clock = std::chrono::steady_clock;
  std::string last_;
  Clock::time_point said_;
};

}  // namespace semantic_vslam
