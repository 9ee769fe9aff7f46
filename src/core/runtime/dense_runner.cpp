// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/runtime/dense_runner.h"

#include <exception>
#include <future>
#include <utility>

#include "core/dense/dense_mapper.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {

DenseRunner::DenseRunner(DenseStage stage, const KeyframeInputsConfig& config, std::size_t kept_frames, Hooks hooks)
    : stage_(std::move(stage)),
      hooks_(std::move(hooks)),
      inputs_(config, kept_frames),
      worker_(
          "slam_dense", kQueue, QueuePolicy::kBlock, [this](const Task& task) { work(task); },
          WorkerPriority::kKeyframes) {}

void DenseRunner::offer(PendingFrame frame) {
  inputs_.with([&](KeyframeInputs& inputs) { inputs.put(std::move(frame)); });
}

void DenseRunner::take(Stamp stamp, const MotionResult& motion) {
  inputs_.with([&](KeyframeInputs& inputs) { inputs.put(stamp, motion); });
}

void DenseRunner::take(const FrameLabels& labels) {
  inputs_.with([&](KeyframeInputs& inputs) { inputs.put(labels); });
  look(labels.stamp);
}

void DenseRunner::take(const FramePlace& place) {
  inputs_.with([&](KeyframeInputs& inputs) { inputs.put(place); });
  look(place.stamp);
}

/// Keyframes go first: while any waits no frame between them is looked at, nor does who brings it wait.
void DenseRunner::look(Stamp stamp) {
  if (worker_.waiting() > 0) return;
  const Running running = hooks_.running();
  auto named = inputs_.with([&](KeyframeInputs& inputs) { return inputs.look(stamp, running); });
  if (named) worker_.push([this, named = std::move(*named)] { integrate(named); });
}

void DenseRunner::take(const LabelSet& label_set) {
  inbox_.put([label_set](DenseStage& stage) { stage.take(label_set); }, true);
  wake();
}

void DenseRunner::take(std::shared_ptr<const MapSnapshot> map) {
  {
    std::lock_guard<std::mutex> lock(newest_mutex_);
    newest_map_ = std::move(map);
  }
  wake();
}

void DenseRunner::name(const KeyframeNotice& keyframe) {
  auto named = inputs_.with([&](KeyframeInputs& inputs) { return inputs.name(keyframe); });
  worker_.push([this, named = std::move(named)] { integrate(named); });
}

void DenseRunner::run(const std::function<void(DenseStage&)>& task) {
  std::promise<void> done;
  const bool taken = worker_.push([&] {
    try {
      task(stage_);
      done.set_value();
    } catch (const std::exception&) {
      done.set_exception(std::current_exception());
    }
  });
  if (!taken) throw Error("the dense map is closed: the stage ends");
  done.get_future().get();
}

/// Who calls must not block: what is new lies where the next task finds it.
void DenseRunner::wake() {
  if (worker_.waiting() == 0) worker_.push([] {});
}

void DenseRunner::work(const Task& task) {
  inbox_.deliver(stage_);
  task();
  std::shared_ptr<const MapSnapshot> map;
  {
    std::lock_guard<std::mutex> lock(newest_mutex_);
    map.swap(newest_map_);
  }
  if (map) stage_.take(*map);
  if (hooks_.after) hooks_.after(stage_);
}

void DenseRunner::integrate(const KeyframeInputs::Named& named) {
  inputs_.waitWhile([&](const KeyframeInputs& inputs, double waited_s) {
    return inputs.worthWaitingS(named, hooks_.running(), waited_s);
  });
  inbox_.deliver(stage_);  // the classes of the labels that it waited for
  const StepClock clock;
  const auto gathered = inputs_.with([&](KeyframeInputs& inputs) { return inputs.gather(named, hooks_.running()); });
  const std::optional<KeyframeInput> input = gathered ? decode(*gathered) : std::nullopt;
  if (!input) return;
  const cv::Mat1b removed = stage_.add(*input);
  if (hooks_.added) hooks_.added(*input, removed, clock.elapsed());
}

void DenseRunner::finish() {
  close();
  worker_.push([] {});  // for the newest map
  worker_.finish();
  stage_.map().finish();
}

KeyframeInputs::Counts DenseRunner::counts() const {
  return inputs_.with([](const KeyframeInputs& inputs) { return inputs.counts(); });
}

}  // namespace semantic_vslam
