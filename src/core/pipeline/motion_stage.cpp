// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/motion_stage.h"

#include <deque>
#include <utility>
#include <vector>

#include "core/common/stamp_order.h"
#include "core/motion/motion_detector.h"
#include "semantic_vslam/core/common/log.h"

namespace semantic_vslam {
namespace {

constexpr std::size_t kMostWaiting = 10;  // label images; older ones would come too late in any case

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
  std::size_t taken = 0, too_late = 0;
};

MotionStage::MotionStage(const MotionConfig& config, const RemovalConfig& removal, double label_delay_s)
    : inside_(std::make_unique<Inside>(config, removal, label_delay_s)) {}
MotionStage::~MotionStage() = default;
MotionStage::MotionStage(MotionStage&&) noexcept = default;

std::optional<MotionResult> MotionStage::step(const RgbdFrame& frame, std::uint32_t recording) {
  const StampOrder::Arrival arrival = inside_->order.of(frame.stamp, recording);
  if (arrival == StampOrder::Arrival::kLate) return std::nullopt;  // tracking counts and says it
  if (arrival != StampOrder::Arrival::kNext) {
    logWarning("stamps went back: motion starts anew");
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

}  // namespace semantic_vslam
