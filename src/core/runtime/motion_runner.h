// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <type_traits>
#include <utility>

#include "core/pipeline/keyframe_inputs.h"
#include "core/pipeline/motion_stage.h"
#include "core/runtime/inbox.h"
#include "core/runtime/step_clock.h"
#include "core/runtime/worker.h"

namespace semantic_vslam {

/// The motion stage on a thread of its own. When it falls behind, the oldest frames that wait are dropped.
class MotionRunner {
 public:
  /// Called on the stage's thread.
  using Sink = std::function<void(const RgbdFrame&, const MotionResult&, StepTime)>;

  MotionRunner(MotionStage stage, std::size_t queue_size, Sink sink);

  void push(PendingFrame frame) { worker_.push(std::move(frame)); }
  /// Anything that MotionStage::take() takes; it counts from the next frame on.
  template <class Message>
  void take(Message message) {
    // Labels and poses come again and again.
    constexpr bool kMustArrive = !std::is_same_v<Message, FrameLabels> && !std::is_same_v<Message, MapSnapshot> &&
                                 !std::is_same_v<Message, TimedPose>;
    inbox_.put([message = std::move(message)](MotionStage& stage) { stage.take(message); }, kMustArrive);
  }
  /// Works off the frames that wait. No push() after it.
  void finish() { worker_.finish(); }

  /// Returns when no frame waits or is in work.
  void settle() { worker_.settle(); }
  QueueCounters counters() const { return worker_.counters(); }
  std::size_t labelsTaken() const { return labels_taken_; }
  std::size_t labelsTooLate() const { return labels_too_late_; }
  std::size_t framesFarApart() const { return far_apart_; }

 private:
  void step(const PendingFrame& pending);

  MotionStage stage_;  // worker only
  const Sink sink_;
  Inbox<MotionStage> inbox_;
  std::atomic<std::size_t> labels_taken_{0}, labels_too_late_{0}, far_apart_{0};
  Worker<PendingFrame> worker_;  ///< last: starts when all else is there
};

}  // namespace semantic_vslam
