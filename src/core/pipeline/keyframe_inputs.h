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

/// All that the dense map takes of a keyframe, but for its pose.
struct KeyframeInput {
  KeyframeNotice keyframe;
  RgbdFrame frame;
  MotionResult motion;
  cv::Mat1b labels;  ///< empty: no network runs
};

/// Brings together by stamp what belongs to a keyframe: images, motion mask and labels, which come at different times.
/// Knows no thread: it says how long to wait, and who runs it waits.
class KeyframeInputs {
 public:
  /// @param kept  newest images and masks that wait for tracking to name one of them
  KeyframeInputs(const KeyframeInputsConfig& config, std::size_t kept);

  void put(PendingFrame frame);
  void put(Stamp stamp, MotionResult motion);
  void put(const FrameLabels& labels);

  /// What is kept of a keyframe from when it is named until its turn comes: by then newer frames have pushed it out.
  struct Named {
    KeyframeNotice keyframe;
    std::optional<PendingFrame> frame;
    std::optional<MotionResult> motion;
  };
  /// To be called as soon as the keyframe is named.
  Named name(const KeyframeNotice& keyframe) const;
  /// @return seconds that it pays to wait for what is missing; 0: gather() now
  double worthWaitingS(const Named& named, const Running& running, double waited_s) const;
  /// All that belongs to a keyframe, its images not decoded yet: that takes long, and somebody may wait for this
  /// object.
  struct Gathered {
    KeyframeNotice keyframe;
    PendingFrame frame;
    MotionResult motion;
    cv::Mat1b labels;
  };
  /// @return nothing if there are no images, or nobody can say where people are in them, or a network runs but passed
  ///         this keyframe over (people who stand would be in it): counted
  std::optional<Gathered> gather(const Named& named, const Running& running);
  bool hasLabels(Stamp stamp) const { return labels_.has(stamp); }

  struct Counts {
    std::size_t without_images = 0, without_mask = 0, unlabelled = 0;
  };
  const Counts& counts() const { return counts_; }

 private:
  KeyframeInputsConfig config_;
  StampedStore<PendingFrame> frames_;
  StampedStore<MotionResult> motion_;
  StampedStore<cv::Mat1b> labels_;
  Counts counts_;
};

/// @return nothing if the images are unusable
std::optional<KeyframeInput> decode(const KeyframeInputs::Gathered& gathered);

}  // namespace semantic_vslam
