// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "semantic_vslam/core/pipeline/slam_system.h"

#include <opencv2/imgproc.hpp>
#include <utility>

#include "core/labels/dynamic_objects.h"
#include "core/runtime/thread_priority.h"
#include "semantic_vslam/core/common/config_fields.h"
#include "semantic_vslam/core/common/log.h"

namespace semantic_vslam {
namespace {

// Keyframes wait here for segmentation and dense mapping; about two seconds of them at a lively pace.
constexpr std::size_t kKeyframeJobs = 16;
// With more than these behind it a keyframe is passed over: its labels would come too late for the motion stage,
// without them a person who stands still would enter the map, and tracking must not wait for the network. Neighbours
// show the same place.
constexpr std::size_t kMostBehindSegmentation = 4;

// While there is no map, labels that the motion stage carries on are good for this long: k2 follows k1 at once, and
// where it does not fit people have moved on after half a second.
constexpr double kFirstLabelsHoldS = 0.5;

cv::Mat1b unite(const cv::Mat1b& dynamic, const cv::Mat1b& removal) {
  return removal.empty() ? dynamic : cv::Mat1b(cv::max(dynamic, removal));
}

}  // namespace

SlamSystem::SlamSystem(const SystemConfig& config, Mode mode)
    : SlamSystem(config, mode, SegmentationStage(config.segmentation)) {}

SlamSystem::SlamSystem(const SystemConfig& config, Mode mode, std::unique_ptr<Segmenter> segmenter)
    : SlamSystem(config, mode, SegmentationStage(config.segmentation, std::move(segmenter))) {}

SlamSystem::SlamSystem(const SystemConfig& config, Mode mode, SegmentationStage segmentation)
    : config_(config),
      mode_(mode),
      motion_(config.motion),
      segmentation_(std::move(segmentation)),
      slam_(config.slam, mode),
      dense_(config.dense, segmentation_.labels()),
      network_works_(segmentation_.enabled()),
      keyframe_jobs_(kKeyframeJobs, QueuePolicy::kBlock) {
  validateConfig(config_);
  if (mode_ == Mode::kBackground) worker_ = std::thread([this] { work(); });
}

SlamSystem::~SlamSystem() {
  keyframe_jobs_.close();
  if (worker_.joinable()) worker_.join();
}

StepResult SlamSystem::step(const RgbdFrame& frame) {
  std::optional<ObservedFrame> observed = observe(frame);
  return observed ? track(std::move(*observed)) : StepResult();
}

std::optional<ObservedFrame> SlamSystem::observe(const RgbdFrame& frame) {
  if (last_stamp_ && frame.stamp <= *last_stamp_) {
    logWarning("frame " + std::to_string(frame.index) + " is not newer than the one before it: passed over");
    return std::nullopt;
  }
  last_stamp_ = frame.stamp;
  auto timer = times_.scope("motion", frame.index);
  takeLateLabels(frame.stamp);
  return ObservedFrame{frame, motion_.detect(frame)};
}

StepResult SlamSystem::track(ObservedFrame observed) {
  StepResult result;
  const RgbdFrame& frame = observed.frame;
  result.motion = std::move(observed.motion);
  const FirstLabels first = firstLabels(frame, result.motion);
  KeyframeJob job{KeyframeId(), frame, result.motion.dynamic, result.motion.moving, {}};
  if (first == FirstLabels::kWanted) job.labels = segment(frame);
  job.dynamic = result.dynamic = unite(result.motion.dynamic, removalMask(job.labels, job.moving));

  // Pose, and whether the frame becomes a keyframe.
  const SparseStep step = slam_.step(frame, result.dynamic, times_);
  result.tracking = step.tracking;
  result.posed = step.tracking.state == TrackingState::kOk;
  result.T_world_camera = step.tracking.T_camera_world.inverse();
  result.keyframe = step.keyframe;

  passOn(step, std::move(job));
  if (first == FirstLabels::kMissing && candidate_) {
    slam_.reset();  // k2 did not fit and may show people: it must not become k1 in its turn
    candidate_.reset();
  }
  return result;
}

SlamSystem::FirstLabels SlamSystem::firstLabels(const RgbdFrame& frame, const MotionResult& motion) const {
  if (slam_.keyframeCount() > 0 || !network_works_) return FirstLabels::kNotNeeded;
  if (motion.labels && secondsBetween(*motion.labels, frame.stamp) < kFirstLabelsHoldS) return FirstLabels::kCarried;
  return candidate_ ? FirstLabels::kMissing : FirstLabels::kWanted;
}

cv::Mat1b SlamSystem::segment(const RgbdFrame& frame) {
  auto timer = times_.scope("segmentation", frame.index);
  const cv::Mat1b labels = segmentation_.process(frame);
  network_works_ = segmentation_.enabled();
  if (!labels.empty()) {
    std::lock_guard<std::mutex> lock(late_mutex_);
    late_labels_.push_back({frame.stamp, labels});
  }
  return labels;
}

void SlamSystem::takeLateLabels(Stamp now) {
  std::lock_guard<std::mutex> lock(late_mutex_);
  while (!late_labels_.empty() && secondsBetween(late_labels_.front().stamp, now) >= config_.label_delay_s) {
    motion_.addLabels(late_labels_.front().stamp, late_labels_.front().labels, segmentation_.labels());
    late_labels_.pop_front();
  }
}

cv::Mat1b SlamSystem::removalMask(const cv::Mat1b& labels, const cv::Mat1b& moving) const {
  cv::Mat1b removal;
  if (!labels.empty()) {
    cv::Mat1b moving_px;
    if (!moving.empty()) cv::resize(moving, moving_px, labels.size(), 0, 0, cv::INTER_LINEAR);
    decideDynamic(labels, segmentation_.labels(), moving_px, config_.segmentation.phi, &removal);
  }
  return removal;
}

void SlamSystem::passOn(const SparseStep& step, KeyframeJob job) {
  if (step.first_keyframe && candidate_) {
    candidate_->id = *step.first_keyframe;
    submit(std::move(*candidate_));
    candidate_.reset();
  }
  if (step.tracking.state == TrackingState::kInitialising) {
    candidate_ = std::move(job);
  } else if (step.keyframe) {
    job.id = *step.keyframe;
    submit(std::move(job));
  } else if (network_works_ && !worker_busy_ && keyframe_jobs_.size() == 0 &&
             config_.segmentation.labelsAreDue(last_submitted_, job.frame.stamp)) {
    submit(std::move(job));
  }
}

void SlamSystem::submit(KeyframeJob job) {
  last_submitted_ = job.frame.stamp;
  if (mode_ == Mode::kSynchronous) {
    finishJob(std::move(job));
  } else {
    keyframe_jobs_.push(std::move(job));
  }
}

void SlamSystem::finishJob(KeyframeJob job) {
  if (job.id.valid()) {
    mapKeyframe(std::move(job));
  } else if (!finishing_) {
    segment(job.frame);
  }
}

void SlamSystem::mapKeyframe(KeyframeJob job) {
  if (job.labels.empty() && network_works_) {
    if (!finishing_ && keyframe_jobs_.size() > kMostBehindSegmentation) {
      ++passed_over_;
      return;
    }
    job.labels = segment(job.frame);
    job.dynamic = unite(job.dynamic, removalMask(job.labels, job.moving));
  }
  if (!config_.dense.enabled) return;
  auto timer = times_.scope("dense_mapping", job.frame.index);
  waiting_.add({job.id, std::move(job.frame), std::move(job.labels), std::move(job.dynamic)});
  mapPlaced();
}

void SlamSystem::mapPlaced() {
  waiting_.keepOnly([this](KeyframeId id) { return slam_.holds(id); });
  const auto poses = slam_.keyframePoses();
  const KeyframeId world = poses.empty() ? KeyframeId() : poses.front().keyframe;
  if (world != world_ && world_.valid()) dense_.clear();  // what it shows was too little for the sparse map to keep
  world_ = world;
  waiting_.place(poses, dense_);
  dense_.updatePoses(poses);
}

void SlamSystem::work() {
  lowerThreadPriority();
  while (auto job = keyframe_jobs_.pop()) {
    worker_busy_ = true;
    finishJob(std::move(*job));
    worker_busy_ = false;
  }
}

void SlamSystem::finish() {
  finishing_ = true;
  slam_.finish();
  if (worker_.joinable()) {
    keyframe_jobs_.close();
    worker_.join();
  }
  if (!config_.dense.enabled) return;
  mapPlaced();
  dense_.finish();
}

}  // namespace semantic_vslam
