// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <thread>

#include "semantic_vslam/core/common/bounded_queue.h"
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
  /// As finish().
  ~SlamRunner();
  SlamRunner(const SlamRunner&) = delete;
  SlamRunner& operator=(const SlamRunner&) = delete;

  /// Returns at once.
  void push(const RgbdFrame& frame) { frames_.push(frame); }
  /// Returns when every frame that was pushed and not dropped has come out of the sink. No push() after it.
  void finish();
  /// Frames that never reached the system.
  std::size_t dropped() const { return frames_.counters().dropped; }

 private:
  void observe();
  void track();

  SlamSystem& system_;
  const Sink sink_;
  BoundedQueue<RgbdFrame> frames_;
  BoundedQueue<ObservedFrame> observed_;
  std::thread observer_, tracker_;  ///< last members: start when all else is there
};

}  // namespace semantic_vslam
