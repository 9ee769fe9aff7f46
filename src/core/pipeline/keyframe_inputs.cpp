// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/keyframe_inputs.h"

#include <algorithm>
#include <utility>

namespace semantic_vslam {
namespace {

// Tracking may be ahead of this stage's own pairing of colour and depth.
constexpr double kImagesWaitS = 0.5;
// Of as many keyframes as may wait for the map; k1 is named after later frames have been labelled.
constexpr std::size_t kLabels = 64;
constexpr double kLabelsDisorderS = 2.0;

}  // namespace

KeyframeInputs::KeyframeInputs(const KeyframeInputsConfig& config, std::size_t kept)
    : config_(config),
      frames_(kept),
      motion_(kept),
      labels_(std::min(kept, kLabels), kLabelsDisorderS),
      places_(kept) {}

void KeyframeInputs::put(PendingFrame frame) {
  const Stamp stamp = frame.stamp;
  // Stamps went back: look_period_s is counted anew.
  if (last_ && newest_ && stamp < *newest_ && stamp < *last_) last_ = stamp;
  newest_ = stamp;
  frames_.put(stamp, std::move(frame));
}

void KeyframeInputs::put(Stamp stamp, MotionResult motion) { motion_.put(stamp, std::move(motion)); }

void KeyframeInputs::put(const FrameLabels& labels) { labels_.put(labels.stamp, labels.labels); }

void KeyframeInputs::put(const FramePlace& place) { places_.put(place.stamp, place); }

KeyframeInputs::Named KeyframeInputs::name(const KeyframeNotice& keyframe) {
  last_ = keyframe.stamp;
  return {keyframe, frames_.find(keyframe.stamp), motion_.find(keyframe.stamp), {}};
}

std::optional<KeyframeInputs::Named> KeyframeInputs::look(Stamp stamp, const Running& running) {
  const auto place = places_.find(stamp);
  if (!place || !last_ || (running.network && !labels_.has(stamp))) return std::nullopt;
  if (secondsBetween(*last_, stamp) < config_.look_period_s) return std::nullopt;
  Named named{
      {place->keyframe, place->map_id, stamp}, frames_.find(stamp), motion_.find(stamp), place->T_keyframe_camera};
  if (!named.frame || (running.motion && !named.motion)) return std::nullopt;
  if (running.motion && !named.motion->told && !labels_.has(stamp)) return std::nullopt;
  last_ = stamp;
  return named;
}

double KeyframeInputs::worthWaitingS(const Named& named, const Running& running, double waited_s) const {
  const Stamp stamp = named.keyframe.stamp;
  const auto left = [waited_s](double patience_s) { return std::max(0.0, patience_s - waited_s); };
  if (!named.frame && !frames_.has(stamp)) return frames_.worthWaitingS(stamp, left(kImagesWaitS));
  double wait_s = 0.0;
  if (running.motion && !named.motion) wait_s = motion_.worthWaitingS(stamp, left(config_.mask_wait_s));
  if (running.network) wait_s = std::max(wait_s, labels_.worthWaitingS(stamp, left(config_.labels_wait_s)));
  return wait_s;
}

std::optional<KeyframeInputs::Gathered> KeyframeInputs::gather(const Named& named, const Running& running) {
  const Stamp stamp = named.keyframe.stamp;
  const auto frame = named.frame ? named.frame : frames_.find(stamp);
  const auto motion = named.motion ? named.motion : motion_.find(stamp);
  const auto labels = labels_.find(stamp);
  if (!frame) {
    ++counts_.without_images;
    return std::nullopt;
  }
  if (!motion) ++counts_.without_mask;
  if (running.network && !labels) {
    ++counts_.unlabelled;
    return std::nullopt;
  }
  if (running.motion && !labels && !(motion && motion->told)) {
    ++counts_.untold;
    return std::nullopt;
  }
  return Gathered{named.keyframe, named.T_keyframe_camera, *frame, motion.value_or(MotionResult()),
                  labels.value_or(cv::Mat1b())};
}

std::optional<KeyframeInput> decode(const KeyframeInputs::Gathered& gathered) {
  const std::optional<RgbdFrame> frame = gathered.frame.decode();
  if (!frame) return std::nullopt;
  return KeyframeInput{gathered.keyframe, gathered.T_keyframe_camera, *frame, gathered.motion, gathered.labels};
}

}  // namespace semantic_vslam
