// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>

#include "core/runtime/dense_runner.h"
#include "core/runtime/label_runner.h"
#include "core/runtime/motion_runner.h"
#include "core/runtime/tracking_runner.h"
#include "semantic_vslam/core/pipeline/config.h"
#include "semantic_vslam/core/pipeline/step_result.h"

namespace semantic_vslam {

/// The four stages wired on threads, with the queues and waiting times of the nodelets: takes frames as a camera sends
/// them. Who falls behind loses the oldest frames that wait, never the pace.
class PipelineRunner {
 public:
  /// Called on the tracking thread for every frame that was tracked, in the frames' order.
  using Sink = std::function<void(const RgbdFrame&, const StepResult&)>;

  /// Opens the network, if one is configured. @throws ConfigError, ModelError
  PipelineRunner(const SystemConfig& config, Sink sink);
  /// @param segmenter  used in place of the configured network
  PipelineRunner(const SystemConfig& config, std::unique_ptr<Segmenter> segmenter, Sink sink);
  ~PipelineRunner();

  /// Returns at once. @return false if the sink has failed: no frame is taken any more, and finish() tells why
  bool push(const RgbdFrame& frame);
  /// Returns when every frame that was pushed and not dropped has come out of the sink, and the maps are complete. No
  /// push() after it. @throws what the first failing call of the sink threw
  void finish();
  /// Frames that were never tracked.
  std::size_t dropped() const;
  /// Keyframes left out of the dense map for want of labels.
  std::size_t keyframesPassedOver() const { return dense_ ? dense_->counts().unlabelled : 0; }

  // Results; call finish() first.
  const SparseSlam& slam() const { return tracking_->stage().slam(); }
  const DenseMapper& dense() const { return dense_->stage().map(); }
  const LabelSet& labels() const { return labels_->labels(); }
  StageTimes& times() { return tracking_->times(); }
  /// Reads the sparse map while the threads run. To be short.
  void read(const std::function<void(const TrackingStage&)>& use) const { tracking_->read(use); }

 private:
  PipelineRunner(const SystemConfig& config, LabelStage labels, Sink sink);
  void onMotion(const RgbdFrame& frame, const MotionResult& motion, StepTime time);
  void onLabels(const RgbdFrame& frame, const FrameLabels& labels, StepTime time);
  void onTracked(const TrackingInput& input, const TrackingOutput& output);
  void onMapChange(const std::shared_ptr<const MapSnapshot>& map);
  Running running() const { return {true, labels_->enabled()}; }
  void join();

  const SystemConfig config_;
  const Sink sink_;
  std::size_t pushed_ = 0;
  std::atomic<std::size_t> tracked_{0};
  std::mutex error_mutex_;
  std::exception_ptr error_;  // guarded by error_mutex_
  std::atomic<bool> failed_{false};
  // In the order in which they are joined, backwards: each gives to those above it.
  std::unique_ptr<DenseRunner> dense_;
  std::unique_ptr<LabelRunner> labels_;
  std::unique_ptr<TrackingRunner> tracking_;
  std::unique_ptr<MotionRunner> motion_;
};

}  // namespace semantic_vslam
