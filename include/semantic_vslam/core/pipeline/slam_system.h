// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>

#include "semantic_vslam/core/camera/rgbd_frame.h"
#include "semantic_vslam/core/common/ids.h"
#include "semantic_vslam/core/common/label_set.h"
#include "semantic_vslam/core/common/stage_timing.h"
#include "semantic_vslam/core/geometry/se3.h"
#include "semantic_vslam/core/motion/motion_result.h"
#include "semantic_vslam/core/pipeline/config.h"
#include "semantic_vslam/core/segmentation/segmenter.h"
#include "semantic_vslam/core/tracking/tracking_state.h"

namespace semantic_vslam {

class DenseMapper;
class SparseSlam;

/// What the whole way made of one frame.
struct StepResult {
  bool posed = false;                    ///< the map gave this frame a pose
  SE3 T_world_camera = SE3::Identity();  ///< valid if posed; a prediction while RECENTLY_LOST
  TrackingEstimate tracking;
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
  enum class Mode { kSynchronous, kBackground };

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

  const SparseSlam& slam() const;
  /// The dense map; call finish() first.
  const DenseMapper& dense() const;
  const LabelSet& labels() const;
  const StageTimes& times() const;
  /// Keyframes left out of the dense map because segmentation was too far behind (kBackground).
  std::size_t keyframesPassedOver() const;

 private:
  class Inside;
  std::unique_ptr<Inside> inside_;
};

}  // namespace semantic_vslam
