// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/runtime/tracking_runner.h"

#include <atomic>
#include <utility>

#include "semantic_vslam/core/common/log.h"

namespace semantic_vslam {
namespace {

// Keyframes come every few frames at most; upkeep that is further behind than this makes tracking wait for it.
constexpr std::size_t kKeyframeQueue = 8;
// For the labels of one frame; the network needs a tenth of it, on a slow and busy machine all. A request may get lost
// while a node is still connecting: then the next frame asks again.
constexpr double kFirstLabelsWaitS = 3.0;

}  // namespace

TrackingRunner::TrackingRunner(TrackingStage stage, const TrackingWaits& waits, std::size_t queue_size, Hooks hooks)
    : waits_(waits),
      hooks_(std::move(hooks)),
      stage_(std::move(stage)),
      pending_upkeep_(0),
      global_adjustment_("slam_global_ba"),
      // It holds the map's lock for moments at low priority; at full priority tracking waits four times as long (95 %
      // of frames), since motion, tracking and decoding need both of two cores.
      upkeep_(
          "slam_upkeep", kKeyframeQueue, QueuePolicy::kBlock, [this](const Upkeep& upkeep) { maintain(upkeep); },
          WorkerPriority::kKeyframes),
      worker_("slam_tracking", queue_size, QueuePolicy::kDropOldest,
              [this](const PendingFrame& frame) { step(frame); }) {}

TrackingRunner::~TrackingRunner() {
  close();
  pending_upkeep_.close();
  abort_adjustment_ = true;
}

void TrackingRunner::take(Stamp stamp, const MotionResult& motion) {
  inputs_.with([&](Inputs& inputs) { inputs.motion.put(stamp, motion); });
}

void TrackingRunner::take(const FrameLabels& labels) {
  inputs_.with([&](Inputs& inputs) { inputs.labels.put(labels.stamp, labels); });
}

void TrackingRunner::take(const LabelSet& label_set) {
  inbox_.put([label_set](TrackingStage& stage) { stage.take(label_set); }, true);
  inputs_.with([](Inputs&) {});  // whether a network runs may have changed for who waits
}

void TrackingRunner::alone(const std::function<void()>& use) const {
  std::lock_guard<std::mutex> lock(map_mutex_);
  use();
}

void TrackingRunner::step(const PendingFrame& pending) {
  bool accepted = false;
  alone([&] {
    inbox_.deliver(stage_);
    accepted = stage_.accepts(pending.stamp, pending.recording, localization_only_);
  });
  if (!accepted) {
    if (++out_of_order_ == 1) {
      logWarning("a frame is passed over, since its stamp does not follow that of the one before; more are counted");
    }
    return;
  }
  if (upkeepIsDone()) tellChanges();  // a recording that is played again has dropped the map: said before the next one
  std::optional<RgbdFrame> frame = pending.decode();
  if (!frame) return;
  TrackingInput input{std::move(*frame), {}, {}, false};
  if (!gatherMotion(input) || !gatherLabels(input)) return;
  TrackingOutput output;
  {
    std::lock_guard<std::mutex> lock(step_mutex_);
    const StepClock clock;
    output = track(input);
    hooks_.tracked(input, output, clock.elapsed());
    pending_upkeep_.with([&](int& pending) { pending += static_cast<int>(output.keyframes.size()); });
  }
  if (upkeepIsDone()) tellChanges();         // else upkeep will: poses are not worth passing on before their adjustment
  requestUpkeep(output, input.frame.index);  // may wait for upkeep
}

/// Waits for the frame's motion mask. @return whether the frame is to be tracked
bool TrackingRunner::gatherMotion(TrackingInput& input) {
  const Stamp stamp = input.frame.stamp;
  inputs_.waitWhile([&](const Inputs& inputs, double waited_s) {
    return hooks_.running().motion ? inputs.motion.worthWaitingS(stamp, 1e-3 * waits_.mask_budget_ms - waited_s) : 0.0;
  });
  const auto [motion, passed_over] = inputs_.with(
      [&](const Inputs& inputs) { return std::pair(inputs.motion.find(stamp), inputs.motion.passedOver(stamp)); });
  const bool fits = motion && motion->dynamic.size() == input.frame.gray.size();
  if (fits) {
    input.motion = *motion;
  } else if (motion) {
    ++without_mask_;
    if (without_mask_ == 1) logWarning("the motion mask has another size than the image: tracked without");
  } else if (passed_over && worker_.waiting() > 0) {
    ++skipped_with_motion_;  // both stages are behind: track the frames that the motion stage had time for
    return false;
  } else {
    ++without_mask_;
  }
  return true;
}

/// Waits for the frame's labels if the start needs them. @return whether the frame is to be tracked
bool TrackingRunner::gatherLabels(TrackingInput& input) {
  const Stamp stamp = input.frame.stamp;
  const auto wanted = [&] {
    input.network_runs = waits_.init_wait_s > 0.0 && hooks_.running().network;
    bool wants = false;
    alone([&] { wants = stage_.wantsLabels(input); });
    return wants;
  };
  if (!wanted()) return true;
  hooks_.labels_wanted(stamp);
  inputs_.waitWhile([&](const Inputs& inputs, double waited_s) {
    return hooks_.running().network ? inputs.labels.worthWaitingS(stamp, kFirstLabelsWaitS - waited_s) : 0.0;
  });
  input.labels = inputs_.with([&](const Inputs& inputs) { return inputs.labels.find(stamp); });
  if (input.labels && input.labels->labels.size() != input.frame.gray.size()) input.labels.reset();
  if (!wanted()) return true;
  ++waited_for_labels_;
  return false;
}

TrackingOutput TrackingRunner::track(const TrackingInput& input) {
  auto timer = times_.scope("tracking", input.frame.index);
  alone([&] { inbox_.deliver(stage_); });  // the classes of the labels that it waited for
  const TrackingStage::Prepared prepared = stage_.prepare(input);
  const TrackingWishes wishes = hooks_.wishes ? hooks_.wishes(input.frame.stamp) : TrackingWishes();
  const TrackOptions options{localization_only_, upkeepIsDone()};
  TrackingOutput output;
  alone([&] { output = stage_.track(input, prepared, options, wishes); });
  return output;
}

void TrackingRunner::requestUpkeep(const TrackingOutput& output, std::uint64_t frame) {
  for (const KeyframeNotice& keyframe : output.keyframes) {
    if (upkeep_.waiting() > 0) abort_adjustment_ = true;  // upkeep falls behind: a newer bundle takes over
    upkeep_.push({keyframe.id, frame});
  }
}

void TrackingRunner::maintain(const Upkeep& upkeep) {
  struct Done {
    Monitor<int>& pending;
    ~Done() {
      pending.with([](int& count) { --count; });
    }
  };
  {
    const Done done{pending_upkeep_};
    maintainMap(upkeep);
  }
  tellChanges();
}

void TrackingRunner::maintainMap(const Upkeep& upkeep) {
  abort_adjustment_ = false;
  const auto use_alone = [this](const std::function<void()>& use) { alone(use); };
  const bool closed = stage_.maintain(upkeep.keyframe, upkeep.frame, times_, use_alone, abort_adjustment_);
  if (closed) {
    global_adjustment_.start([this, upkeep, use_alone](const std::atomic<bool>& abort) {
      stage_.adjustAll(upkeep.frame, times_, use_alone, abort);
    });
  }
}

/// Takes time where the map is large, so nobody waits for it: who comes while another thread tells leaves it to that
/// one.
void TrackingRunner::tellChanges() {
  if (to_tell_.fetch_add(1) > 0) return;
  int told_for = 0;
  do {
    told_for = to_tell_;
    std::shared_ptr<const MapSnapshot> now;
    alone([&] { now = stage_.snapshot(); });
    if (std::exchange(told_, now) != now) hooks_.map_changed(now);
  } while (to_tell_.fetch_sub(told_for) != told_for);
}

bool TrackingRunner::upkeepIsDone() {
  return pending_upkeep_.with([](int pending) { return pending == 0; });
}

/// Locks step_mutex_ at a moment when no upkeep is due.
std::unique_lock<std::mutex> TrackingRunner::lockBetweenUpkeep() {
  while (true) {
    pending_upkeep_.waitWhile([](int pending, double) { return pending > 0 ? 1.0 : 0.0; });
    std::unique_lock<std::mutex> lock(step_mutex_);
    if (upkeepIsDone()) return lock;
  }
}

void TrackingRunner::change(const std::function<void(TrackingStage&)>& use) {
  const std::unique_lock<std::mutex> lock = lockBetweenUpkeep();
  global_adjustment_.cancel();
  alone([&] { use(stage_); });
  tellChanges();
}

void TrackingRunner::read(const std::function<void(const TrackingStage&)>& use) const {
  alone([&] { use(stage_); });
}

void TrackingRunner::finish() {
  worker_.finish();
  upkeep_.finish();
  global_adjustment_.wait();
  tellChanges();
}

TrackingRunner::Counts TrackingRunner::counts() const {
  return {without_mask_, skipped_with_motion_, waited_for_labels_, out_of_order_};
}

}  // namespace semantic_vslam
