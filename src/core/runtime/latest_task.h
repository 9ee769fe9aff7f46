// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

namespace semantic_vslam {

/// Runs tasks on a thread of its own, of low priority, of which only the newest matters: a new one aborts the one in
/// work and replaces one that waits. An
/// exception costs the task, never the process. All functions may be called by any thread, but not by the task itself.
class LatestTask {
 public:
  /// @param abort  set when the task's result is no longer wanted; it should look often and return soon
  using Task = std::function<void(const std::atomic<bool>& abort)>;

  /// @param name  of the thread, see nameThread()
  explicit LatestTask(const char* name) : name_(name) {}
  ~LatestTask();  ///< aborts what is in work and waits for it
  LatestTask(const LatestTask&) = delete;
  LatestTask& operator=(const LatestTask&) = delete;

  void start(Task task);
  /// Aborts what is in work, drops what waits, and returns when nothing runs.
  void cancel();
  /// Returns when nothing runs.
  void wait();

 private:
  using Flag = std::shared_ptr<std::atomic<bool>>;  // one for each task, so that none inherits another's abort

  void run();

  const char* const name_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<Task> next_;  // guarded by mutex_
  Flag in_work_;              // guarded by mutex_; null = idle
  bool closed_ = false;       // guarded by mutex_
  std::thread thread_;        // guarded by mutex_ until the destructor; started with the first task
};

}  // namespace semantic_vslam
