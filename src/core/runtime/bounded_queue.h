// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

namespace semantic_vslam {

/// What push() does when the queue is full: frames drop the oldest, keyframes block.
enum class QueuePolicy { kDropOldest, kBlock };

struct QueueCounters {
  std::size_t pushed = 0;
  std::size_t dropped = 0;
  std::size_t high_water = 0;
  std::size_t failed = 0;  ///< whose work threw, where a Worker takes them
};

/// Bounded queue between two threads, with a named policy and counters for the diagnostics.
template <class T>
class BoundedQueue {
 public:
  BoundedQueue(std::size_t capacity, QueuePolicy policy) : capacity_(capacity), policy_(policy) {}

  /// @return false if the queue is closed; the item is then discarded.
  bool push(T item) {
    std::unique_lock<std::mutex> lock(mutex_);
    if (policy_ == QueuePolicy::kBlock) {
      has_room_.wait(lock, [this] { return closed_ || items_.size() < capacity_; });
    }
    if (closed_) return false;
    if (items_.size() >= capacity_) {
      items_.pop_front();
      ++counters_.dropped;
    }
    items_.push_back(std::move(item));
    ++counters_.pushed;
    counters_.high_water = std::max(counters_.high_water, items_.size());
    has_item_.notify_one();
    return true;
  }

  /// Waits for an item. @return nothing once the queue is closed and empty.
  std::optional<T> pop() {
    std::unique_lock<std::mutex> lock(mutex_);
    has_item_.wait(lock, [this] { return closed_ || !items_.empty(); });
    return takeFront();
  }

  std::optional<T> tryPop() {
    std::unique_lock<std::mutex> lock(mutex_);
    return takeFront();
  }

  /// Wakes every waiter; items already queued can still be popped.
  void close() {
    std::lock_guard<std::mutex> lock(mutex_);
    closed_ = true;
    has_item_.notify_all();
    has_room_.notify_all();
  }

  void clear() {
    std::lock_guard<std::mutex> lock(mutex_);
    items_.clear();
    has_room_.notify_all();
  }

  std::size_t size() const {
    std::lock_guard<std::mutex> lock(mutex_);
    return items_.size();
  }

  QueueCounters counters() const {
    std::lock_guard<std::mutex> lock(mutex_);
    return counters_;
  }

 private:
  /// Call with mutex_ held.
  std::optional<T> takeFront() {
    if (items_.empty()) return std::nullopt;
    std::optional<T> item(std::move(items_.front()));
    items_.pop_front();
    has_room_.notify_one();
    return item;
  }

  const std::size_t capacity_;
  const QueuePolicy policy_;
  mutable std::mutex mutex_;
  std::condition_variable has_item_, has_room_;
  std::deque<T> items_;     // guarded by mutex_
  QueueCounters counters_;  // guarded by mutex_
  bool closed_ = false;     // guarded by mutex_
};

}  // namespace semantic_vslam
