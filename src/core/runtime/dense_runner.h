// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>

#include "core/pipeline/dense_stage.h"
#include "core/runtime/inbox.h"
#include "core/runtime/monitor.h"
#include "core/runtime/step_clock.h"
#include "core/runtime/worker.h"

namespace semantic_vslam {

/// The dense map's stage on a thread of its own, of low priority: it waits for what belongs to a keyframe, and does all
/// work on the map. When it is far behind, who names a keyframe waits.
class DenseRunner {
 public:
  struct Hooks {
    std::function<Running()> running;  ///< asked while it waits
    std::function<void(const KeyframeInput&, const cv::Mat1b& removed, StepTime)>
        added;                               ///< after a keyframe, on the stage's thread
    std::function<void(DenseStage&)> after;  ///< after each piece of work, on the stage's thread
  };
  static constexpr std::size_t kQueue = 64;

  DenseRunner(DenseStage stage, const KeyframeInputsConfig& config, std::size_t kept_frames, Hooks hooks);
  ~DenseRunner() { close(); }

  void offer(PendingFrame frame);
  void take(Stamp stamp, const MotionResult& motion);
  void take(const FrameLabels& labels);
  void take(const LabelSet& label_set);
  void take(std::shared_ptr<const MapSnapshot> map);
  void take(const FramePlace& place);
  /// A keyframe; its images and mask are taken now, while they are here. May block.
  void name(const KeyframeNotice& keyframe);
  /// Runs a task on the stage's thread and waits for it; what it throws is thrown here.
  void run(const std::function<void(DenseStage&)>& task);
  /// Has `after` called soon.
  void wake();
  /// Nobody waits for missing inputs any more.
  void close() { inputs_.close(); }
  /// Works off what waits. Only then the stage may be used from outside.
  void finish();
  const DenseStage& stage() const { return stage_; }

  /// Returns when nothing waits or is in work.
  void settle() { worker_.settle(); }
  QueueCounters counters() const { return worker_.counters(); }
  std::size_t waiting() const { return worker_.waiting(); }
  KeyframeInputs::Counts counts() const;

 private:
  using Task = std::function<void()>;
  void work(const Task& task);
  void integrate(const KeyframeInputs::Named& named);
  void look(Stamp stamp);

  DenseStage stage_;  // worker only, until finish()
  const Hooks hooks_;
  mutable Monitor<KeyframeInputs> inputs_;
  Inbox<DenseStage> inbox_;
  std::mutex newest_mutex_;
  std::shared_ptr<const MapSnapshot> newest_map_;  // guarded by newest_mutex_; not taken yet
  Worker<Task> worker_;                            ///< last: starts when all else is there
};

}  // namespace semantic_vslam
