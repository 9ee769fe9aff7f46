// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/runtime/label_runner.h"

namespace semantic_vslam {
namespace {

// Who asks may be ahead of this stage's own pairing of colour and depth.
constexpr double kImagesWaitS = 0.5;
// k1 and k2 are named at once; of others the newest two.
constexpr std::size_t kWaiting = 2;

}  // namespace

LabelRunner::LabelRunner(LabelStage stage, std::size_t kept_frames, Sink sink, std::function<void()> broke_down)
    : stage_(std::move(stage)),
      labels_(stage_.labels()),
      sink_(std::move(sink)),
      broke_down_(std::move(broke_down)),
      frames_(kept_frames),
      enabled_(stage_.enabled()),
      worker_(
          "slam_labels", kWaiting, QueuePolicy::kDropOldest, [this](const Job& job) { step(job); },
          WorkerPriority::kKeyframes) {}

void LabelRunner::offer(PendingFrame frame) {
  const Stamp stamp = frame.stamp;
  frames_.with([&](auto& frames) { frames.put(stamp, std::move(frame)); });
  std::lock_guard<std::mutex> lock(push_mutex_);
  if (enabled_ && worker_.idle()) worker_.push({stamp, false});
}

void LabelRunner::ask(Stamp stamp) {
  std::lock_guard<std::mutex> lock(push_mutex_);
  if (enabled_) worker_.push({stamp, true});
}

void LabelRunner::take(const MapSnapshot& map) {
  if (!enabled_) return;  // nobody would deliver it
  const bool exists = map.keyframes() > 0;
  inbox_.put([exists](LabelStage& stage) { stage.setMapExists(exists); });
}

void LabelRunner::step(const Job& job) {
  if (!enabled_) return;
  inbox_.deliver(stage_);
  if (!job.asked && !stage_.isDue(job.stamp)) return;
  frames_.waitWhile(
      [&](const auto& frames, double waited_s) { return frames.worthWaitingS(job.stamp, kImagesWaitS - waited_s); });
  const auto pending = frames_.with([&](const auto& frames) { return frames.find(job.stamp); });
  const StepClock clock;
  const std::optional<RgbdFrame> frame = pending ? pending->decode() : std::nullopt;
  if (!frame) {
    ++without_images_;
    return;
  }
  const std::optional<FrameLabels> labels = stage_.step(*frame);
  if (labels) sink_(*frame, *labels, clock.elapsed());
  if (stage_.enabled()) return;
  enabled_ = false;
  if (broke_down_) broke_down_();
}

}  // namespace semantic_vslam
