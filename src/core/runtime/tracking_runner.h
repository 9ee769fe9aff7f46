// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>

#include "core/common/stamped_store.h"
#include "core/pipeline/keyframe_inputs.h"
#include "core/pipeline/tracking_stage.h"
#include "core/runtime/inbox.h"
#include "core/runtime/latest_task.h"
#include "core/runtime/monitor.h"
#include "core/runtime/step_clock.h"
#include "core/runtime/worker.h"

namespace semantic_vslam {

/// Tracking on threads: frames on one, of which the oldest that wait are dropped when it falls behind; the map's upkeep
/// on another and global bundle adjustment on a third, both of low priority. A step waits for these only for the length
/// of a map update.
class TrackingRunner {
 public:
  struct Hooks {
    std::function<Running()> running;  ///< asked while it waits
    /// A frame is done. No reset or loadMap() comes between a frame and this call.
    std::function<void(const TrackingInput&, const TrackingOutput&, StepTime)> tracked;
    /// Keyframes or their poses have changed: after a frame, or after the map's upkeep where some is due. One call at a
    /// time, but it may be beside `tracked` and late: of a map that a reset has dropped meanwhile.
    std::function<void(const std::shared_ptr<const MapSnapshot>&)> map_changed;
    std::function<void(Stamp)> labels_wanted;     ///< the start waits for this frame's labels
    std::function<TrackingWishes(Stamp)> wishes;  ///< what who looks at the results would like of a frame; may be empty
  };
  struct Counts {
    std::size_t without_mask = 0, skipped_with_motion = 0, waited_for_labels = 0, out_of_order = 0;
  };

  TrackingRunner(TrackingStage stage, const TrackingWaits& waits, std::size_t queue_size, Hooks hooks);
  ~TrackingRunner();

  /// @return false if no frame is taken any more
  bool push(PendingFrame frame) { return worker_.push(std::move(frame)); }
  void take(Stamp stamp, const MotionResult& motion);
  void take(const FrameLabels& labels);
  void take(const LabelSet& label_set);
  void setLocalizationOnly(bool on) { localization_only_ = on; }
  bool localizationOnly() const { return localization_only_; }

  /// Uses the stage between two frames, with the upkeep so far done and global adjustment ended. What use() throws is
  /// thrown here.
  void change(const std::function<void(TrackingStage&)>& use);
  /// Reads the stage while nobody changes it. To be short.
  void read(const std::function<void(const TrackingStage&)>& use) const;
  /// Nobody waits for missing inputs any more.
  void close() { inputs_.close(); }
  /// Works off the frames that wait and their upkeep. Only then the stage may be used without a lock.
  void finish();
  const TrackingStage& stage() const { return stage_; }

  StageTimes& times() { return times_; }
  const StageTimes& times() const { return times_; }
  /// Returns when no frame and no upkeep waits or is in work, but for global adjustment.
  void settle() {
    worker_.settle();
    upkeep_.settle();
  }
  QueueCounters counters() const { return worker_.counters(); }
  std::size_t waiting() const { return worker_.waiting(); }
  Counts counts() const;

 private:
  struct Inputs {
    StampedStore<MotionResult> motion{30};
    StampedStore<FrameLabels> labels{4, 2.0};
  };
  struct Upkeep {
    KeyframeId keyframe;
    std::uint64_t frame;  ///< index of the frame that it was made with
  };

  void step(const PendingFrame& pending);
  bool gatherMotion(TrackingInput& input);
  bool gatherLabels(TrackingInput& input);
  TrackingOutput track(const TrackingInput& input);
  void requestUpkeep(const TrackingOutput& output, std::uint64_t frame);
  void maintain(const Upkeep& upkeep);
  void maintainMap(const Upkeep& upkeep);
  void tellChanges();
  bool upkeepIsDone();
  std::unique_lock<std::mutex> lockBetweenUpkeep();
  void alone(const std::function<void()>& use) const;

  const TrackingWaits waits_;
  const Hooks hooks_;
  StageTimes times_;
  Monitor<Inputs> inputs_;
  Inbox<TrackingStage> inbox_;
  std::atomic<bool> localization_only_{false};
  std::atomic<std::size_t> without_mask_{0}, skipped_with_motion_{0}, waited_for_labels_{0}, out_of_order_{0};

  std::mutex step_mutex_;                    ///< a frame and what is told of it are one with the map they belong to
  mutable std::mutex map_mutex_;             ///< taken after step_mutex_ where both are; the stage is used under it
  TrackingStage stage_;                      // guarded by map_mutex_, but for prepare()
  std::atomic<int> to_tell_{0};              ///< calls of tellChanges() that the map has changed for
  std::shared_ptr<const MapSnapshot> told_;  // of the thread that tells
  std::atomic<bool> abort_adjustment_{false};
  Monitor<int> pending_upkeep_;  ///< keyframes queued or in work
  LatestTask global_adjustment_;
  Worker<Upkeep> upkeep_;
  Worker<PendingFrame> worker_;  ///< last: starts when all else is there
};

}  // namespace semantic_vslam
