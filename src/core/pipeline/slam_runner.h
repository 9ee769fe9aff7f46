// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

#include "core/runtime/bounded_queue.h"
#include "semantic_vslam/core/pipeline/slam_system.h"

namespace semantic_vslam {

/// Takes frames as a camera sends them: motion of one frame beside tracking of the one before, each on a thread of its
/// own with a queue before it, as the nodelets do. Who falls behind loses the oldest frames that wait, never the pace.
class SlamRunner {
 public:
  /// Called on the tracking thread, in the frames' order.
  using Sink = std::function<void(const RgbdFrame&, const StepResult&)>;

  /// @param system  of Mode::kBackground; must outlive this, and take no step() meanwhile
  SlamRunner(SlamSystem& system, Sink sink);
  /// As finish(), but throws nothing.
  ~SlamRunner();
  SlamRunner(const SlamRunner&) = delete;
  SlamRunner& operator=(const SlamRunner&) = delete;

  /// Returns at once. @return false if a step or the sink has failed: no frame is taken any more, and finish() tells
  /// why
  bool push(const RgbdFrame& frame) { return frames_.push(frame); }
  /// Returns when every frame that was pushed and not dropped has come out of the sink. No push() after it.
  /// @throws what the first failing step or call of the sink threw
  void finish();
  /// Frames that never reached the system.
  std::size_t dropped() const { return frames_.counters().dropped; }

 private:
  void observe();
  void track();
  /// Calls it, and ends both threads' work if it throws.
  void guarded(const std::function<void()>& work);
  void join();

  SlamSystem& system_;
  const Sink sink_;
  BoundedQueue<RgbdFrame> frames_;
  BoundedQueue<ObservedFrame> observed_;
  std::mutex error_mutex_;
  std::exception_ptr error_;        // guarded by error_mutex_
  std::thread observer_, tracker_;  ///< last members: start when all else is there
};

}  // namespace semantic_vslam
