// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>

#include "core/common/stamped_store.h"
#include "semantic_vslam/core/camera/rgbd_frame.h"
#include "semantic_vslam/core/motion/motion_result.h"
#include "semantic_vslam/core/pipeline/config.h"
#include "semantic_vslam/core/pipeline/messages.h"

namespace semantic_vslam {

/// A frame that may never be needed: it is decoded when somebody asks for it.
struct PendingFrame {
  Stamp stamp;
  std::uint32_t recording = 0;  ///< see StampOrder
  /// @return nothing if the images are unusable
  std::function<std::optional<RgbdFrame>()> decode;
};

/// Which stages run beside this one, so that what they make may be waited for.
struct Running {
  bool motion = true, network = false;
};

/// All that the dense map takes of a keyframe, but for its pose; or of a frame between keyframes.
struct KeyframeInput {
  KeyframeNotice keyframe;  ///< a frame between: the stamp is its own, the rest that of the keyframe it lies beside
  std::optional<SE3> T_keyframe_camera;  ///< of a frame between
  RgbdFrame frame;
  MotionResult motion;
  cv::Mat1b labels;  ///< empty: no network runs
};

/// Says which frames the dense map takes, and brings together by stamp what belongs to each: images, motion mask and
/// labels, which come at different times. Knows no thread: it says how long to wait, and who runs it waits.
class KeyframeInputs {
 public:
  /// @param kept  newest images and masks that wait for tracking to name one of them
  KeyframeInputs(const KeyframeInputsConfig& config, std::size_t kept);

  void put(PendingFrame frame);
  void put(Stamp stamp, MotionResult motion);
  void put(const FrameLabels& labels);
  void put(const FramePlace& place);

  /// What is kept of a keyframe from when it is named until its turn comes: by then newer frames have pushed it out.
  struct Named {
    KeyframeNotice keyframe;
    std::optional<PendingFrame> frame;
    std::optional<MotionResult> motion;
    std::optional<SE3> T_keyframe_camera;
  };
  /// To be called as soon as the keyframe is named.
  Named name(const KeyframeNotice& keyframe);
  /// A frame between keyframes, once all that belongs to it is here, where none came for look_period_s: a camera that
  /// stands makes no keyframes, and what changes before it would stay in the map, or never come in. To be called after
  /// each put() of a place or labels. @param stamp  theirs
  std::optional<Named> look(Stamp stamp, const Running& running);
  /// @return seconds that it pays to wait for what is missing; 0: gather() now
  double worthWaitingS(const Named& named, const Running& running, double waited_s) const;
  /// All that belongs to a keyframe, its images not decoded yet: that takes long, and somebody may wait for this
  /// object.
  struct Gathered {
    KeyframeNotice keyframe;
    std::optional<SE3> T_keyframe_camera;
    PendingFrame frame;
    MotionResult motion;
    cv::Mat1b labels;
  };
  /// @return nothing if there are no images, or nobody can say where people are in them, or a network runs but passed
  ///         this keyframe over (people who stand would be in it): counted
  std::optional<Gathered> gather(const Named& named, const Running& running);
  bool hasLabels(Stamp stamp) const { return labels_.has(stamp); }

  struct Counts {
    std::size_t without_images = 0, without_mask = 0, unlabelled = 0, untold = 0;
  };
  const Counts& counts() const { return counts_; }

 private:
  KeyframeInputsConfig config_;
  StampedStore<PendingFrame> frames_;
  StampedStore<MotionResult> motion_;
  StampedStore<cv::Mat1b> labels_;
  StampedStore<FramePlace> places_;
  std::optional<Stamp> last_;    ///< newest frame that was taken
  std::optional<Stamp> newest_;  ///< frame that came last
  Counts counts_;
};

/// @return nothing if the images are unusable
std::optional<KeyframeInput> decode(const KeyframeInputs::Gathered& gathered);

}  // namespace semantic_vslam
