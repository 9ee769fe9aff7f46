// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "semantic_vslam/core/runtime/pipeline_runner.h"

#include <utility>

#include "semantic_vslam/core/common/config_fields.h"

namespace semantic_vslam {
namespace {

// As many as wait before a nodelet by default: a sixth of a second.
constexpr std::size_t kWaitingFrames = 5;
// As many as a nodelet keeps by default: a second.
constexpr std::size_t kKeptFrames = 30;

}  // namespace

PipelineRunner::PipelineRunner(const SystemConfig& config, Sink sink)
    : PipelineRunner(config, LabelStage(config.segmentation), std::move(sink)) {}

PipelineRunner::PipelineRunner(const SystemConfig& config, std::unique_ptr<Segmenter> segmenter, Sink sink)
    : PipelineRunner(config, LabelStage(config.segmentation, std::move(segmenter)), std::move(sink)) {}

PipelineRunner::PipelineRunner(const SystemConfig& config, LabelStage labels, Sink sink)
    : config_(config), sink_(std::move(sink)) {
  validateConfig(config_);
  const LabelSet label_set = labels.labels();
  MotionStage motion(config_.motion, config_.label_delay_s);
  motion.take(label_set);
  TrackingStage tracking(config_.slam, config_.waits, config_.removal);
  tracking.take(label_set);
  DenseStage dense(config_.dense, config_.removal);
  dense.take(label_set);

  // Nothing is pushed before all are there, so none calls another one that is not.
  dense_ = std::make_unique<DenseRunner>(
      std::move(dense), config_.inputs, kKeptFrames,
      DenseRunner::Hooks{[this] { return running(); },
                         [this](const KeyframeInput& input, StepTime time) {
                           times().add({"dense_mapping", input.frame.index, time.wall_ms, time.cpu_ms});
                         },
                         {}});
  labels_ = std::make_unique<LabelRunner>(
      std::move(labels), kKeptFrames,
      [this](const RgbdFrame& frame, const FrameLabels& labelled, StepTime time) { onLabels(frame, labelled, time); });
  tracking_ = std::make_unique<TrackingRunner>(
      std::move(tracking), config_.waits, kWaitingFrames,
      TrackingRunner::Hooks{
          [this] { return running(); },
          [this](const TrackingInput& input, const TrackingOutput& output, StepTime) { onTracked(input, output); },
          [this](const std::shared_ptr<const MapSnapshot>& map) { onMapChange(map); },
          [this](Stamp stamp) { labels_->ask(stamp); },
          {}});
  motion_ = std::make_unique<MotionRunner>(
      std::move(motion), kWaitingFrames,
      [this](const RgbdFrame& frame, const MotionResult& result, StepTime time) { onMotion(frame, result, time); });
}

PipelineRunner::~PipelineRunner() {
  tracking_->close();
  labels_->close();
  dense_->close();
  join();
}

bool PipelineRunner::push(const RgbdFrame& frame) {
  if (failed_) return false;
  const PendingFrame pending{frame.stamp, 0, [frame] { return frame; }};
  ++pushed_;
  // First to those who only keep it: when a frame is named a keyframe they have it.
  if (config_.dense.enabled) dense_->offer(pending);
  labels_->offer(pending);
  tracking_->push(pending);
  motion_->push(pending);
  return true;
}

void PipelineRunner::onMotion(const RgbdFrame& frame, const MotionResult& motion, StepTime time) {
  times().add({"motion", frame.index, time.wall_ms, time.cpu_ms});
  dense_->take(frame.stamp, motion);
  tracking_->take(frame.stamp, motion);
}

void PipelineRunner::onLabels(const RgbdFrame& frame, const FrameLabels& labels, StepTime time) {
  times().add({"segmentation", frame.index, time.wall_ms, time.cpu_ms});
  motion_->take(labels);
  tracking_->take(labels);
  dense_->take(labels);
}

void PipelineRunner::onTracked(const TrackingInput& input, const TrackingOutput& output) {
  ++tracked_;
  for (const KeyframeNotice& keyframe : output.keyframes) {
    labels_->ask(keyframe.stamp);
    if (config_.dense.enabled) dense_->name(keyframe);
  }
  if (failed_) return;
  try {
    sink_(input.frame, StepResult{output, input.motion});
  } catch (...) {
    std::lock_guard<std::mutex> lock(error_mutex_);
    if (!error_) error_ = std::current_exception();
    failed_ = true;
  }
}

void PipelineRunner::onMapChange(const std::shared_ptr<const MapSnapshot>& map) {
  motion_->take(*map);
  labels_->take(*map);
  if (config_.dense.enabled) dense_->take(map);
}

void PipelineRunner::join() {
  motion_->finish();
  tracking_->finish();
  labels_->finish();
  dense_->finish();
}

void PipelineRunner::finish() {
  join();
  std::exception_ptr error;
  {
    std::lock_guard<std::mutex> lock(error_mutex_);
    error = std::exchange(error_, nullptr);
  }
  if (error) std::rethrow_exception(error);
}

std::size_t PipelineRunner::dropped() const { return pushed_ - tracked_; }

}  // namespace semantic_vslam
