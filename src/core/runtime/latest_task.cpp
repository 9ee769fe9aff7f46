// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/runtime/latest_task.h"

#include <atomic>
#include <exception>
#include <string>
#include <utility>

#include "core/runtime/this_thread.h"
#include "semantic_vslam/core/common/log.h"

namespace semantic_vslam {

LatestTask::~LatestTask() {
  {
    std::lock_guard<std::mutex> lock(mutex_);
    closed_ = true;
    next_.reset();
    if (in_work_) *in_work_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void LatestTask::start(Task task) {
  {
    std::lock_guard<std::mutex> lock(mutex_);
    if (in_work_) *in_work_ = true;
    next_ = std::move(task);
    if (!thread_.joinable()) thread_ = std::thread([this] { run(); });
  }
  changed_.notify_all();
}

void LatestTask::cancel() {
  {
    std::lock_guard<std::mutex> lock(mutex_);
    next_.reset();
    if (in_work_) *in_work_ = true;
  }
  wait();
}

void LatestTask::wait() {
  std::unique_lock<std::mutex> lock(mutex_);
  changed_.wait(lock, [this] { return !in_work_ && !next_; });
}

void LatestTask::run() {
  nameThread(name_);
  lowerThreadPriority();
  std::unique_lock<std::mutex> lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return closed_ || next_; });
    if (closed_) return;
    const Task task = std::move(*next_);
    next_.reset();
    const Flag abort = in_work_ = std::make_shared<std::atomic<bool>>(false);
    lock.unlock();
    try {
      task(*abort);
    } catch (const std::exception& error) {
      logError(std::string("global adjustment is given up: ") + error.what());
    }
    lock.lock();
    in_work_.reset();
    changed_.notify_all();
  }
}

}  // namespace semantic_vslam
