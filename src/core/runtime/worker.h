// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "core/runtime/bounded_queue.h"
#include "core/runtime/this_thread.h"
#include "semantic_vslam/core/common/log.h"

namespace semantic_vslam {

/// kKeyframes: work that may take its time gives way to what every frame waits for, where cores are few.
enum class WorkerPriority { kFrames, kKeyframes };

/// One thread that works off a bounded queue, so that who pushes goes on at once. Dropped items are counted. An
/// exception costs the item, never the process.
template <class T>
class Worker {
 public:
  using Handler = std::function<void(T)>;

  /// Starts at once: construct it after everything that the handler uses. @param name  see nameThread()
  Worker(const char* name, std::size_t capacity, QueuePolicy policy, Handler handler,
         WorkerPriority priority = WorkerPriority::kFrames)
      : queue_(capacity, policy), handler_(std::move(handler)), thread_([this, name, priority] {
          nameThread(name);
          if (priority == WorkerPriority::kKeyframes) lowerThreadPriority();
          run();
        }) {}

  /// Drops what waits, finishes what runs.
  ~Worker() {
    queue_.clear();
    finish();
  }
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  /// @return false if nothing is taken any more
  bool push(T item) { return queue_.push(std::move(item)); }
  /// Finishes what waits and what runs. No push() after it.
  void finish() {
    queue_.close();
    if (thread_.joinable()) thread_.join();
  }
  /// Returns when nothing waits and nothing runs.
  void settle() {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [this] { return idle(); });
  }
  std::size_t waiting() const { return queue_.size(); }
  /// Nothing waits and nothing runs.
  bool idle() const {
    const QueueCounters counters = queue_.counters();
    return counters.pushed - counters.dropped == done_;
  }
  QueueCounters counters() const {
    QueueCounters counters = queue_.counters();
    counters.failed = failed_;
    return counters;
  }

 private:
  void run() {
    while (std::optional<T> item = queue_.pop()) {
      try {
        handler_(std::move(*item));
      } catch (const std::exception& error) {
        // Said for the 1st, 2nd, 4th, 8th, ... of them: what fails once may fail thirty times a second.
        const std::size_t failed = ++failed_;
        if ((failed & (failed - 1)) == 0) {
          logError("a frame or keyframe is lost, the " + std::to_string(failed) + ". so far: " + error.what());
        }
      }
      {
        std::lock_guard<std::mutex> lock(mutex_);
        ++done_;
      }
      changed_.notify_all();
    }
  }

  BoundedQueue<T> queue_;
  const Handler handler_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::atomic<std::size_t> done_{0}, failed_{0};
  std::thread thread_;
};

}  // namespace semantic_vslam
