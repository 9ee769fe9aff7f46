// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/motion_stage.h"

#include <deque>
#include <string>
#include <utility>
#include <vector>

#include "core/common/stamp_order.h"
#include "core/motion/motion_detector.h"
#include "semantic_vslam/core/common/log.h"

namespace semantic_vslam {
namespace {

constexpr std::size_t kMostWaiting = 10;  // label images; older ones would come too late in any case
constexpr int kSaidFrom = 3;              // gaps in a row

}  // namespace

struct MotionStage::Inside {
  Inside(const MotionConfig& config, const RemovalConfig& removal, double label_delay_s)
      : delay_s(label_delay_s), detector(config, removal) {}

  /// Gives the detector the labels whose frame it has seen. @param now  of the frame to come
  void passLabelsOn(Stamp now) {
    if (!label_set) return;
    std::deque<FrameLabels> early;
    for (FrameLabels& labels : waiting) {
      if (labels.stamp > last_stamp || secondsBetween(labels.stamp, now) < delay_s) {
        early.push_back(std::move(labels));
      } else {
        ++(detector.addLabels(labels.stamp, labels.labels, *label_set) ? taken : too_late);
      }
    }
    waiting = std::move(early);
  }

  /// Counts frames that are too far apart to compare them. One gap is a hiccup of the driver, more are its rate.
  void noteGap(StampOrder::Arrival arrival, Stamp now) {
    const double gap_s = arrival == StampOrder::Arrival::kNext && any_frame ? secondsBetween(last_stamp, now) : 0.0;
    any_frame = true;
    const bool far = gap_s > MotionDetector::kLongestGapS;
    if (far) ++far_apart;
    far_in_a_row = far ? far_in_a_row + 1 : 0;
    if (far_in_a_row < kSaidFrom || gap_said) return;
    gap_said = true;
    logWarning("frames are " + std::to_string(gap_s) + " s apart by their stamps: above " +
               std::to_string(MotionDetector::kLongestGapS) +
               " s motion cannot be told, and without labels such frames are not mapped; give more frames a second, "
               "and the seconds at which they were taken as their stamps");
  }

  /// Tells the detector where frames stand: keyframes first, whichever came first.
  void passPosesOn() {
    if (keyframe_poses) detector.takeKeyframePoses(*keyframe_poses);
    if (frame_pose) detector.takeFramePose(*frame_pose);
    keyframe_poses.reset();
    frame_pose.reset();
  }

  const double delay_s;
  MotionDetector detector;
  std::optional<std::vector<TimedPose>> keyframe_poses;  ///< newest, not passed on yet
  std::optional<TimedPose> frame_pose;                   ///< likewise
  StampOrder order;
  Stamp last_stamp;
  std::deque<FrameLabels> waiting;
  std::optional<LabelSet> label_set;
  std::size_t taken = 0, too_late = 0, far_apart = 0;
  bool any_frame = false, gap_said = false;
  int far_in_a_row = 0;
};

MotionStage::MotionStage(const MotionConfig& config, const RemovalConfig& removal, double label_delay_s)
    : inside_(std::make_unique<Inside>(config, removal, label_delay_s)) {}
MotionStage::~MotionStage() = default;
MotionStage::MotionStage(MotionStage&&) noexcept = default;

std::optional<MotionResult> MotionStage::step(const RgbdFrame& frame, std::uint32_t recording) {
  const StampOrder::Arrival arrival = inside_->order.of(frame.stamp, recording);  // tracking says what is to be said
  if (arrival == StampOrder::Arrival::kOutOfOrder) return std::nullopt;
  inside_->noteGap(arrival, frame.stamp);
  if (arrival != StampOrder::Arrival::kNext) {
    inside_->waiting.clear();  // of the stamps before
    inside_->detector.reset();
  }
  inside_->passLabelsOn(frame.stamp);
  inside_->passPosesOn();
  inside_->last_stamp = frame.stamp;
  return inside_->detector.detect(frame);
}

void MotionStage::take(FrameLabels labels) {
  inside_->waiting.push_back(std::move(labels));
  if (inside_->waiting.size() > kMostWaiting) inside_->waiting.pop_front();
}

void MotionStage::take(const LabelSet& label_set) { inside_->label_set = label_set; }

void MotionStage::take(const MapSnapshot& map) {
  std::vector<TimedPose> poses;
  poses.reserve(map.poses.size());
  for (const KeyframePose& keyframe : map.poses) poses.push_back({keyframe.stamp, keyframe.T_world_camera});
  inside_->keyframe_poses = std::move(poses);
}

void MotionStage::take(const TimedPose& pose) { inside_->frame_pose = pose; }

void MotionStage::take(const MotionConfig& config) { inside_->detector.setConfig(config); }

void MotionStage::take(const RemovalConfig& removal) { inside_->detector.setConfig(removal); }

std::size_t MotionStage::labelsTaken() const { return inside_->taken; }
std::size_t MotionStage::labelsTooLate() const { return inside_->too_late; }
std::size_t MotionStage::framesFarApart() const { return inside_->far_apart; }

}  // namespace semantic_vslam
