// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "semantic_vslam/core/pipeline/slam_system.h"

#include <atomic>
#include <deque>
#include <mutex>
#include <opencv2/imgproc.hpp>
#include <string>
#include <thread>
#include <utility>

#include "core/dense/dense_mapper.h"
#include "core/dense/waiting_keyframes.h"
#include "core/labels/dynamic_objects.h"
#include "core/motion/motion_detector.h"
#include "core/pipeline/sparse_slam.h"
#include "core/runtime/bounded_queue.h"
#include "core/runtime/thread_priority.h"
#include "core/segmentation/segmentation_stage.h"
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

class SlamSystem::Inside {
 public:
  Inside(const SystemConfig& config, Mode mode, SegmentationStage segmentation);
  ~Inside();

  StepResult step(const RgbdFrame& frame);
  std::optional<ObservedFrame> observe(const RgbdFrame& frame);
  StepResult track(ObservedFrame observed);
  void finish();

  const SparseSlam& slam() const { return slam_; }
  const DenseMapper& dense() const { return dense_; }
  const LabelSet& labels() const { return segmentation_.labels(); }
  const StageTimes& times() const { return times_; }
  std::size_t keyframesPassedOver() const { return passed_over_; }

 private:
  /// A keyframe on its way into the dense map, or a frame between keyframes that is only segmented.
  struct KeyframeJob {
    KeyframeId id;  ///< invalid: only segmented
    RgbdFrame frame;
    cv::Mat1b dynamic, moving;  ///< of MotionResult
    cv::Mat1b labels;           ///< empty: not segmented yet
  };
  struct LateLabels {
    Stamp stamp;
    cv::Mat1b labels;
  };

  void takeLateLabels(Stamp now);
  /// What is known of people in a frame before there is a map, whose first frame must hold none.
  enum class FirstLabels {
    kNotNeeded,  ///< there is a map, or no network
    kCarried,    ///< the motion stage carries fresh ones on to this frame
    kWanted,     ///< the frame may become k1: to be segmented
    kMissing     ///< the frame may become k2, whose people motion detection removes
  };
  FirstLabels firstLabels(const RgbdFrame& frame, const MotionResult& motion) const;
  /// Labels of a frame, for the motion stage too.
  cv::Mat1b segment(const RgbdFrame& frame);
  /// People and moving objects of the labels, 255; empty without labels.
  cv::Mat1b removalMask(const cv::Mat1b& labels, const cv::Mat1b& moving) const;
  void passOn(const SparseStep& step, KeyframeJob job);
  void submit(KeyframeJob job);
  void finishJob(KeyframeJob job);
  void mapKeyframe(KeyframeJob job);
  /// Adds the waiting keyframes whose place in the world is known by now to the dense map.
  void mapPlaced();
  void work();

  const SystemConfig config_;
  const Mode mode_;
  StageTimes times_;
  MotionDetector motion_;           // used by observe()
  SegmentationStage segmentation_;  // used by track() until initialised, then by the worker
  SparseSlam slam_;
  DenseMapper dense_;                     // used by the worker
  WaitingKeyframes waiting_;              // used by the worker
  KeyframeId world_;                      // used by the worker: first keyframe of the map that dense_ shows
  std::optional<Stamp> last_stamp_;       // used by observe()
  Stamp last_submitted_;                  // used by track()
  std::optional<KeyframeJob> candidate_;  ///< k1, until initialisation has made it the first keyframe

  std::mutex late_mutex_;
  std::deque<LateLabels> late_labels_;  // guarded by late_mutex_
  std::atomic<bool> network_works_;     ///< there is one, and it has not failed
  std::atomic<bool> worker_busy_{false};
  std::atomic<bool> finishing_{false};  ///< nobody waits for tracking any more
  std::atomic<std::size_t> passed_over_{0};
  BoundedQueue<KeyframeJob> keyframe_jobs_;
  std::thread worker_;  ///< last member: starts when all else is there, joined first
};

SlamSystem::Inside::Inside(const SystemConfig& config, Mode mode, SegmentationStage segmentation)
    : config_(config),
      mode_(mode),
      motion_(config.motion),
      segmentation_(std::move(segmentation)),
      slam_(config.slam, mode == Mode::kSynchronous ? SparseSlam::Mode::kSynchronous : SparseSlam::Mode::kBackground),
      dense_(config.dense, segmentation_.labels()),
      network_works_(segmentation_.enabled()),
      keyframe_jobs_(kKeyframeJobs, QueuePolicy::kBlock) {
  validateConfig(config_);
  if (mode_ == Mode::kBackground) worker_ = std::thread([this] { work(); });
}

SlamSystem::Inside::~Inside() {
  keyframe_jobs_.close();
  if (worker_.joinable()) worker_.join();
}

StepResult SlamSystem::Inside::step(const RgbdFrame& frame) {
  std::optional<ObservedFrame> observed = observe(frame);
  return observed ? track(std::move(*observed)) : StepResult();
}

std::optional<ObservedFrame> SlamSystem::Inside::observe(const RgbdFrame& frame) {
  if (last_stamp_ && frame.stamp <= *last_stamp_) {
    logWarning("frame " + std::to_string(frame.index) + " is not newer than the one before it: passed over");
    return std::nullopt;
  }
  last_stamp_ = frame.stamp;
  auto timer = times_.scope("motion", frame.index);
  takeLateLabels(frame.stamp);
  return ObservedFrame{frame, motion_.detect(frame)};
}

StepResult SlamSystem::Inside::track(ObservedFrame observed) {
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

SlamSystem::Inside::FirstLabels SlamSystem::Inside::firstLabels(const RgbdFrame& frame,
                                                                const MotionResult& motion) const {
  if (slam_.keyframeCount() > 0 || !network_works_) return FirstLabels::kNotNeeded;
  if (motion.labels && secondsBetween(*motion.labels, frame.stamp) < kFirstLabelsHoldS) return FirstLabels::kCarried;
  return candidate_ ? FirstLabels::kMissing : FirstLabels::kWanted;
}

cv::Mat1b SlamSystem::Inside::segment(const RgbdFrame& frame) {
  auto timer = times_.scope("segmentation", frame.index);
  const cv::Mat1b labels = segmentation_.process(frame);
  network_works_ = segmentation_.enabled();
  if (!labels.empty()) {
    std::lock_guard<std::mutex> lock(late_mutex_);
    late_labels_.push_back({frame.stamp, labels});
  }
  return labels;
}

void SlamSystem::Inside::takeLateLabels(Stamp now) {
  std::lock_guard<std::mutex> lock(late_mutex_);
  while (!late_labels_.empty() && secondsBetween(late_labels_.front().stamp, now) >= config_.label_delay_s) {
    motion_.addLabels(late_labels_.front().stamp, late_labels_.front().labels, segmentation_.labels());
    late_labels_.pop_front();
  }
}

cv::Mat1b SlamSystem::Inside::removalMask(const cv::Mat1b& labels, const cv::Mat1b& moving) const {
  cv::Mat1b removal;
  if (!labels.empty()) {
    cv::Mat1b moving_px;
    if (!moving.empty()) cv::resize(moving, moving_px, labels.size(), 0, 0, cv::INTER_LINEAR);
    decideDynamic(labels, segmentation_.labels(), moving_px, config_.segmentation.phi, &removal);
  }
  return removal;
}

void SlamSystem::Inside::passOn(const SparseStep& step, KeyframeJob job) {
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

void SlamSystem::Inside::submit(KeyframeJob job) {
  last_submitted_ = job.frame.stamp;
  if (mode_ == Mode::kSynchronous) {
    finishJob(std::move(job));
  } else {
    keyframe_jobs_.push(std::move(job));
  }
}

void SlamSystem::Inside::finishJob(KeyframeJob job) {
  if (job.id.valid()) {
    mapKeyframe(std::move(job));
  } else if (!finishing_) {
    segment(job.frame);
  }
}

void SlamSystem::Inside::mapKeyframe(KeyframeJob job) {
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

void SlamSystem::Inside::mapPlaced() {
  waiting_.keepOnly([this](KeyframeId id) { return slam_.holds(id); });
  const auto poses = slam_.keyframePoses();
  const KeyframeId world = poses.empty() ? KeyframeId() : poses.front().keyframe;
  if (world != world_ && world_.valid()) dense_.clear();  // what it shows was too little for the sparse map to keep
  world_ = world;
  waiting_.place(poses, dense_);
  dense_.updatePoses(poses);
}

void SlamSystem::Inside::work() {
  lowerThreadPriority();
  while (auto job = keyframe_jobs_.pop()) {
    worker_busy_ = true;
    finishJob(std::move(*job));
    worker_busy_ = false;
  }
}

void SlamSystem::Inside::finish() {
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

SlamSystem::SlamSystem(const SystemConfig& config, Mode mode)
    : inside_(std::make_unique<Inside>(config, mode, SegmentationStage(config.segmentation))) {}

SlamSystem::SlamSystem(const SystemConfig& config, Mode mode, std::unique_ptr<Segmenter> segmenter)
    : inside_(std::make_unique<Inside>(config, mode, SegmentationStage(config.segmentation, std::move(segmenter)))) {}

SlamSystem::~SlamSystem() = default;

StepResult SlamSystem::step(const RgbdFrame& frame) { return inside_->step(frame); }
std::optional<ObservedFrame> SlamSystem::observe(const RgbdFrame& frame) { return inside_->observe(frame); }
StepResult SlamSystem::track(ObservedFrame observed) { return inside_->track(std::move(observed)); }
void SlamSystem::finish() { inside_->finish(); }
const SparseSlam& SlamSystem::slam() const { return inside_->slam(); }
const DenseMapper& SlamSystem::dense() const { return inside_->dense(); }
const LabelSet& SlamSystem::labels() const { return inside_->labels(); }
const StageTimes& SlamSystem::times() const { return inside_->times(); }
std::size_t SlamSystem::keyframesPassedOver() const { return inside_->keyframesPassedOver(); }

}  // namespace semantic_vslam
