// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <mutex>
#include <optional>

#include "core/common/stamped_store.h"
#include "core/pipeline/keyframe_inputs.h"
#include "core/pipeline/label_stage.h"
#include "core/runtime/inbox.h"
#include "core/runtime/monitor.h"
#include "core/runtime/step_clock.h"
#include "core/runtime/worker.h"

namespace semantic_vslam {

/// The labels' stage on a thread of its own, of low priority. The newest wins: what the network has no time for is
/// never labelled.
class LabelRunner {
 public:
  /// Called on the stage's thread.
  using Sink = std::function<void(const RgbdFrame&, const FrameLabels&, StepTime)>;

  /// @param kept_frames  newest frames that wait for somebody to ask for one of them
  /// @param broke_down   the network has failed: there are no labels any more
  LabelRunner(LabelStage stage, std::size_t kept_frames, Sink sink, std::function<void()> broke_down = {});
  ~LabelRunner() { close(); }

  /// A frame that nobody has asked for yet.
  void offer(PendingFrame frame);
  /// A keyframe, or a frame that tracking waits for.
  void ask(Stamp stamp);
  void take(const MapSnapshot& map);
  /// Nobody waits any more.
  void close() { frames_.close(); }
  /// Works off what waits.
  void finish() { worker_.finish(); }

  bool enabled() const { return enabled_; }
  const LabelSet& labels() const { return labels_; }
  /// Returns when nothing waits or is in work.
  void settle() { worker_.settle(); }
  QueueCounters counters() const { return worker_.counters(); }
  std::size_t withoutImages() const { return without_images_; }

 private:
  struct Job {
    Stamp stamp;
    bool asked = false;
  };
  void step(const Job& job);

  LabelStage stage_;  // worker only
  const LabelSet labels_;
  const Sink sink_;
  const std::function<void()> broke_down_;
  Monitor<StampedStore<PendingFrame>> frames_;
  Inbox<LabelStage> inbox_;
  std::atomic<bool> enabled_;
  std::atomic<std::size_t> without_images_{0};
  std::mutex push_mutex_;  ///< an offered frame must not push out one that was asked for
  Worker<Job> worker_;     ///< last: starts when all else is there
};

}  // namespace semantic_vslam
