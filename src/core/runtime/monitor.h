// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <utility>

namespace semantic_vslam {

/// State that several threads share: each uses it alone, and who lacks something in it waits for the next change.
template <class State>
class Monitor {
 public:
  template <class... Arguments>
  explicit Monitor(Arguments&&... arguments) : state_(std::forward<Arguments>(arguments)...) {}

  /// Calls use(state) and wakes who waits. @return what it returns
  template <class Use>
  auto with(Use&& use) {
    std::lock_guard<std::mutex> lock(mutex_);
    changed_.notify_all();
    return use(state_);
  }

  /// Waits while that pays. @param worth_waiting_s  (const State&, seconds waited so far) -> seconds more; 0: enough
  template <class Worth>
  void waitWhile(const Worth& worth_waiting_s) const {
    using Clock = std::chrono::steady_clock;
    std::unique_lock<std::mutex> lock(mutex_);
    const Clock::time_point begin = Clock::now();
    while (!closed_) {
      const double more_s = worth_waiting_s(std::as_const(state_), secondsSince(begin));
      if (more_s <= 0.0) return;
      constexpr double kLongest = 3600.0;  // within what the clock can add
      changed_.wait_for(lock, std::chrono::duration<double>(std::min(more_s, kLongest)));
    }
  }

  /// Nobody waits any more.
  void close() {
    std::lock_guard<std::mutex> lock(mutex_);
    closed_ = true;
    changed_.notify_all();
  }

 private:
  static double secondsSince(std::chrono::steady_clock::time_point begin) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }

  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  State state_;          // guarded by mutex_
  bool closed_ = false;  // guarded by mutex_
};

}  // namespace semantic_vslam
