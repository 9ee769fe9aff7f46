// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "core/dense/dense_mapper.h"
#include "core/dense/waiting_keyframes.h"
#include "core/motion/motion_detector.h"
#include "core/runtime/bounded_queue.h"
#include "core/segmentation/segmentation_stage.h"
#include "semantic_vslam/core/common/stage_timing.h"
#include "semantic_vslam/core/pipeline/config.h"
#include "semantic_vslam/core/pipeline/sparse_slam.h"

namespace semantic_vslam {

/// What the whole way made of one frame.
struct StepResult {
  bool posed = false;                    ///< the map gave this frame a pose
  SE3 T_world_camera = SE3::Identity();  ///< valid if posed; a prediction while RECENTLY_LOST
  TrackingResult tracking;
  std::optional<KeyframeId> keyframe;  ///< set if the frame became a keyframe
  MotionResult motion;
  cv::Mat1b dynamic;  ///< what tracking was told: motion, and people of the first frames' labels; 0..255
};

/// A frame and what moves in it.
struct ObservedFrame {
  RgbdFrame frame;
  MotionResult motion;
};

/// The whole way of a frame: observe() finds what moves, track() segments k1, finds the pose and, for a keyframe, its
/// labels, removes what moves and maps the rest.
class SlamSystem {
 public:
  /// kSynchronous: everything within step(), the same bytes out for the same bytes in. kBackground: map upkeep on one
  /// worker, segmentation and dense mapping on another, so that step() is done within a frame's time.
  using Mode = SparseSlam::Mode;

  /// Opens the network, if one is configured. @throws ConfigError, ModelError
  SlamSystem(const SystemConfig& config, Mode mode);
  /// @param segmenter  used in place of the configured network
  SlamSystem(const SystemConfig& config, Mode mode, std::unique_ptr<Segmenter> segmenter);
  ~SlamSystem();
  SlamSystem(const SlamSystem&) = delete;
  SlamSystem& operator=(const SlamSystem&) = delete;

  /// observe() and track().
  /// @param frame  stamps must grow; a frame whose stamp does not is passed over with a warning
  StepResult step(const RgbdFrame& frame);
  /// First half of a step: motion that the camera's own does not explain, and the people of labels that have arrived.
  /// Asks nothing of track(), so that one thread may observe while another tracks the frame before.
  /// @return nothing for a frame that is passed over
  std::optional<ObservedFrame> observe(const RgbdFrame& frame);
  /// Second half, of the observed frames in their order. While there is no map it segments k1, which must hold no
  /// people; the motion stage carries these labels on to the frames after it.
  StepResult track(ObservedFrame observed);

  /// Waits for the workers and brings the dense map to the keyframes' last poses. Call before reading results; no
  /// step() after it.
  void finish();

  const SparseSlam& slam() const { return slam_; }
  /// The dense map; call finish() first.
  const DenseMapper& dense() const { return dense_; }
  const LabelSet& labels() const { return segmentation_.labels(); }
  const StageTimes& times() const { return times_; }
  /// Keyframes left out of the dense map because segmentation was too far behind (kBackground).
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

  SlamSystem(const SystemConfig& config, Mode mode, SegmentationStage segmentation);

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

}  // namespace semantic_vslam
