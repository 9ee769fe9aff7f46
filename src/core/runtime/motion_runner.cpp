// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/runtime/motion_runner.h"

namespace semantic_vslam {

MotionRunner::MotionRunner(MotionStage stage, std::size_t queue_size, Sink sink)
    : stage_(std::move(stage)),
      sink_(std::move(sink)),
      worker_("slam_motion", queue_size, QueuePolicy::kDropOldest, [this](const PendingFrame& frame) { step(frame); }) {
}

void MotionRunner::step(const PendingFrame& pending) {
  const StepClock clock;
  inbox_.deliver(stage_);
  const std::optional<RgbdFrame> frame = pending.decode();
  if (!frame) return;
  const std::optional<MotionResult> motion = stage_.step(*frame, pending.recording);
  labels_taken_ = stage_.labelsTaken();
  labels_too_late_ = stage_.labelsTooLate();
  far_apart_ = stage_.framesFarApart();
  if (motion) sink_(*frame, *motion, clock.elapsed());
}

}  // namespace semantic_vslam
