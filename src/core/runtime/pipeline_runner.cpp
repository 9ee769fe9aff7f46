// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "semantic_vslam/core/runtime/pipeline_runner.h"

#include <atomic>
#include <exception>
#include <mutex>
#include <utility>

#include "core/runtime/dense_runner.h"
#include "core/runtime/label_runner.h"
#include "core/runtime/motion_runner.h"
#include "core/runtime/tracking_runner.h"
#include "semantic_vslam/core/common/config_fields.h"

namespace semantic_vslam {
namespace {

// As many as wait before a nodelet by default: a sixth of a second.
constexpr std::size_t kWaitingFrames = 5;
// As many as a nodelet keeps by default: a second.
constexpr std::size_t kKeptFrames = 30;

}  // namespace

class PipelineRunner::Threads {
 public:
  Threads(const SystemConfig& config, LabelStage labels, Sink sink);
  ~Threads();

  bool push(const RgbdFrame& frame);
  void settle();
  void finish();
  std::size_t dropped() const { return pushed_ - tracked_; }
  const TrackingRunner& tracking() const { return *tracking_; }
  const DenseRunner& dense() const { return *dense_; }

 private:
  void onMotion(const RgbdFrame& frame, const MotionResult& motion, StepTime time);
  void onLabels(const RgbdFrame& frame, const FrameLabels& labels, StepTime time);
  void onTracked(const TrackingInput& input, const TrackingOutput& output);
  void onMapChange(const std::shared_ptr<const MapSnapshot>& map);
  TrackingRunner::Hooks trackingHooks();
  void time(const char* stage, const RgbdFrame& frame, StepTime time);
  Running running() const { return {true, labels_->enabled()}; }
  void join();

  const SystemConfig config_;
  const Sink sink_;
  std::size_t pushed_ = 0;
  std::atomic<std::size_t> tracked_{0};
  std::mutex error_mutex_;
  std::exception_ptr error_;  // guarded by error_mutex_
  std::atomic<bool> failed_{false};
  // In the order in which they are made; joined in the other one: each gives to those above it.
  std::unique_ptr<DenseRunner> dense_;
  std::unique_ptr<LabelRunner> labels_;
  std::unique_ptr<TrackingRunner> tracking_;
  std::unique_ptr<MotionRunner> motion_;
};

PipelineRunner::Threads::Threads(const SystemConfig& config, LabelStage labels, Sink sink)
    : config_(config), sink_(std::move(sink)) {
  validateConfig(config_);
  const LabelSet label_set = labels.labels();
  MotionStage motion(config_.motion, config_.removal, config_.label_delay_s);
  motion.take(label_set);
  TrackingStage tracking(config_.slam, config_.waits, config_.removal);
  tracking.take(label_set);
  DenseStage dense(config_.dense, config_.removal);
  dense.take(label_set);

  // Nothing is pushed before all are there, so none calls another one that is not.
  DenseRunner::Hooks dense_hooks;
  dense_hooks.running = [this] { return running(); };
  dense_hooks.added = [this](const auto& input, const auto&, StepTime taken) {
    time("dense_mapping", input.frame, taken);
  };
  dense_ = std::make_unique<DenseRunner>(std::move(dense), config_.inputs, kKeptFrames, std::move(dense_hooks));
  labels_ = std::make_unique<LabelRunner>(
      std::move(labels), kKeptFrames,
      [this](const auto& frame, const auto& labelled, StepTime taken) { onLabels(frame, labelled, taken); });
  tracking_ = std::make_unique<TrackingRunner>(std::move(tracking), config_.waits, kWaitingFrames, trackingHooks());
  motion_ = std::make_unique<MotionRunner>(
      std::move(motion), kWaitingFrames,
      [this](const auto& frame, const auto& result, StepTime taken) { onMotion(frame, result, taken); });
}

TrackingRunner::Hooks PipelineRunner::Threads::trackingHooks() {
  TrackingRunner::Hooks hooks;
  hooks.running = [this] { return running(); };
  hooks.tracked = [this](const auto& input, const auto& output, StepTime) { onTracked(input, output); };
  hooks.map_changed = [this](const auto& map) { onMapChange(map); };
  hooks.labels_wanted = [this](Stamp stamp) { labels_->ask(stamp); };
  return hooks;
}

PipelineRunner::Threads::~Threads() {
  tracking_->close();
  labels_->close();
  dense_->close();
  join();
}

bool PipelineRunner::Threads::push(const RgbdFrame& frame) {
  if (failed_) return false;
  ++pushed_;
  const PendingFrame pending{frame.stamp, 0, [frame] { return frame; }};
  // First to those who only keep it: when a frame is named a keyframe they have it.
  if (config_.dense.enabled) dense_->offer(pending);
  labels_->offer(pending);
  tracking_->push(pending);
  motion_->push(pending);
  return true;
}

void PipelineRunner::Threads::time(const char* stage, const RgbdFrame& frame, StepTime taken) {
  tracking_->times().add({stage, frame.index, taken.wall_ms, taken.cpu_ms});
}

void PipelineRunner::Threads::onMotion(const RgbdFrame& frame, const MotionResult& motion, StepTime taken) {
  time("motion", frame, taken);
  if (config_.dense.enabled) dense_->take(frame.stamp, motion);
  tracking_->take(frame.stamp, motion);
}

void PipelineRunner::Threads::onLabels(const RgbdFrame& frame, const FrameLabels& labels, StepTime taken) {
  time("segmentation", frame, taken);
  motion_->take(labels);
  tracking_->take(labels);
  if (config_.dense.enabled) dense_->take(labels);
}

void PipelineRunner::Threads::onTracked(const TrackingInput& input, const TrackingOutput& output) {
  ++tracked_;
  if (output.posed()) motion_->take(TimedPose{input.frame.stamp, output.tracking.T_camera_world.inverse()});
  for (const KeyframeNotice& keyframe : output.keyframes) {
    labels_->ask(keyframe.stamp);
    if (config_.dense.enabled) dense_->name(keyframe);
  }
  if (config_.dense.enabled && output.place) dense_->take(*output.place);
  if (failed_) return;
  try {
    sink_(input.frame, StepResult{output, input.motion, {}});
  } catch (...) {
    std::lock_guard<std::mutex> lock(error_mutex_);
    if (!error_) error_ = std::current_exception();
    failed_ = true;
  }
}

void PipelineRunner::Threads::onMapChange(const std::shared_ptr<const MapSnapshot>& map) {
  motion_->take(*map);
  labels_->take(*map);
  if (config_.dense.enabled) dense_->take(map);
}

void PipelineRunner::Threads::join() {
  motion_->finish();
  tracking_->finish();
  labels_->finish();
  dense_->finish();
}

/// Each gives only to those after it.
void PipelineRunner::Threads::settle() {
  motion_->settle();
  tracking_->settle();
  labels_->settle();
  dense_->settle();
}

void PipelineRunner::Threads::finish() {
  join();
  std::exception_ptr error;
  {
    std::lock_guard<std::mutex> lock(error_mutex_);
    error = std::exchange(error_, nullptr);
  }
  if (error) std::rethrow_exception(error);
}

PipelineRunner::PipelineRunner(const SystemConfig& config, Sink sink)
    : threads_(std::make_unique<Threads>(config, LabelStage(config.segmentation), std::move(sink))) {}
PipelineRunner::PipelineRunner(const SystemConfig& config, std::unique_ptr<Segmenter> segmenter, Sink sink)
    : threads_(
          std::make_unique<Threads>(config, LabelStage(config.segmentation, std::move(segmenter)), std::move(sink))) {}
PipelineRunner::~PipelineRunner() = default;

bool PipelineRunner::push(const RgbdFrame& frame) { return threads_->push(frame); }
void PipelineRunner::settle() { threads_->settle(); }
void PipelineRunner::finish() { threads_->finish(); }
std::size_t PipelineRunner::dropped() const { return threads_->dropped(); }
std::size_t PipelineRunner::keyframesPassedOver() const { return threads_->dense().counts().unlabelled; }
const SparseSlam& PipelineRunner::slam() const { return threads_->tracking().stage().slam(); }
const DenseMapper& PipelineRunner::dense() const { return threads_->dense().stage().map(); }
const StageTimes& PipelineRunner::times() const { return threads_->tracking().times(); }
void PipelineRunner::read(const std::function<void(const SparseSlam&)>& use) const {
  threads_->tracking().read([&](const TrackingStage& stage) { use(stage.slam()); });
}

}  // namespace semantic_vslam
