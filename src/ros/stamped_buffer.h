// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <utility>

#include "semantic_vslam/core/common/stamp.h"

namespace semantic_vslam {

/// The newest few values of a stream, found by stamp. Thread-safe.
template <class T>
class StampedBuffer {
 public:
  /// @param disorder_s  by how much a stream's stamps may go back within one recording
  explicit StampedBuffer(std::size_t capacity, double disorder_s = 0.0)
      : capacity_(capacity), disorder_s_(disorder_s) {}

  /// Adds or replaces. When full, the oldest goes. A stamp that goes back begins a new recording: all else goes.
  void put(Stamp stamp, T value) {
    std::lock_guard<std::mutex> lock(mutex_);
    if (!values_.empty() && secondsBetween(stamp, values_.rbegin()->first) > disorder_s_) values_.clear();
    values_[stamp] = std::move(value);
    if (values_.size() > capacity_) values_.erase(values_.begin());
    changed_.notify_all();
  }

  std::optional<T> find(Stamp stamp) const {
    std::lock_guard<std::mutex> lock(mutex_);
    return findLocked(stamp);
  }

  /// Waits until the value of this stamp is there. Gives up after the budget, at once if a value has come that is newer
  /// by the disorder or more (its source skipped this one), and when closed.
  std::optional<T> waitFor(Stamp stamp, std::chrono::milliseconds budget) const {
    std::unique_lock<std::mutex> lock(mutex_);
    const auto skipped = [&] { return secondsBetween(stamp, values_.rbegin()->first) >= disorder_s_; };
    changed_.wait_for(lock, budget,
                      [&] { return closed_ || (!values_.empty() && (values_.count(stamp) > 0 || skipped())); });
    return findLocked(stamp);
  }

  /// @return stamp of the newest value.
  std::optional<Stamp> newest() const {
    std::lock_guard<std::mutex> lock(mutex_);
    return values_.empty() ? std::nullopt : std::optional<Stamp>(values_.rbegin()->first);
  }

  /// Wakes every waiter for good.
  void close() {
    std::lock_guard<std::mutex> lock(mutex_);
    closed_ = true;
    changed_.notify_all();
  }

 private:
  std::optional<T> findLocked(Stamp stamp) const {
    const auto found = values_.find(stamp);
    return found == values_.end() ? std::nullopt : std::optional<T>(found->second);
  }

  const std::size_t capacity_;
  const double disorder_s_;
  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  std::map<Stamp, T> values_;  // guarded by mutex_
  bool closed_ = false;        // guarded by mutex_
};

}  // namespace semantic_vslam
