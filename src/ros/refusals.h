// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/console.h>

#include <cstddef>
#include <exception>
#include <mutex>
#include <string>

#include "core/common/input_file.h"
#include "ros/log_throttle.h"

namespace semantic_vslam {

/// The one rule for what comes from outside, message, image or call: what cannot be used costs itself alone. It is
/// counted, and said in one line with its topic. ROS calls back on threads where an exception would end all nodelets of
/// the process.
class Refusals {
 public:
  /// @return whether use() came to its end
  template <class Use>
  bool guard(const std::string& topic, Use&& use) {
    try {
      use();
      return true;
    } catch (const std::exception& error) {
      refuse(topic, error.what());
      return false;
    }
  }

  /// For what is wrong without an exception.
  void refuse(const std::string& topic, const std::string& reason) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (say(topic + " refused: " + printable(reason))) ROS_ERROR("%s", last_.c_str());
  }
  /// For what is used, though it can hardly be meant.
  void doubt(const std::string& topic, const std::string& reason) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (say(topic + " is doubtful: " + printable(reason))) ROS_WARN("%s", last_.c_str());
  }

  std::size_t count() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return count_;
  }
  /// What was refused last and why, with what to do; "" if nothing was.
  std::string last() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return last_;
  }

 private:
  bool say(const std::string& what) {
    ++count_;
    last_ = what;
    return throttle_.passes(last_);
  }

  mutable std::mutex mutex_;
  std::size_t count_ = 0;  // guarded by mutex_, as all
  std::string last_;
  LogThrottle throttle_;
};

}  // namespace semantic_vslam
