// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>
#include <ros/subscriber.h>

#include <atomic>
#include <optional>
#include <string>

#include "core/dense/waiting_keyframes.h"
#include "ros/kept_frames.h"
#include "ros/stage_diagnostics.h"
#include "ros/stamped_buffer.h"
#include "semantic_vslam/core/common/label_set.h"
#include "semantic_vslam/core/segmentation/segmentation_config.h"

namespace semantic_vslam {

/// What the map needs to know of segmentation's configuration.
struct DecisionConfig {
  double phi = SegmentationConfig{}.phi;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("phi", phi, 0.0, 1.0, "eq. (5): an object moves when more than this share of its mask moves");
  }
};

struct KeyframeInputsConfig {
  double labels_wait_s = 3.0;
  double mask_wait_s = 0.5;
  KeptFramesConfig frames;
  DecisionConfig segmentation;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("labels_wait_s", labels_wait_s, 0.0, 30.0,
            "s a keyframe waits for its labels while a network runs; without them it stays out of the map");
    v.field("mask_wait_s", mask_wait_s, 0.0, 30.0, "s a keyframe waits for its motion mask");
    frames.visit(v);
    v.group("segmentation", segmentation);
  }
};

/// What is kept of a keyframe from when it is named until its turn comes: by then newer frames have pushed it out.
struct KeyframeImages {
  std::optional<RgbdMessages> pair;
  std::optional<cv::Mat1b> mask;
};

/// Gathers by stamp what belongs to a keyframe: images, motion mask and labels, which come on topics of their own and
/// at different times. Subscribes to the images, motion/mask and segmentation/labels.
class KeyframeInputs {
 public:
  /// @throws FileError or ConfigError, see KeptFrames
  KeyframeInputs(ros::NodeHandle nh, ros::NodeHandle private_nh, const KeyframeInputsConfig& config);

  /// What is here already of a keyframe. To be called as soon as it is named.
  KeyframeImages imagesNow(Stamp stamp) const { return {frames_.find(stamp), masks_.find(stamp)}; }
  /// Waits for what is missing, at most the times in the configuration. One thread makes all calls.
  /// @param labels  that segmentation uses
  /// @return nothing if there are no images, or nobody can say where people are in them, or a network runs but passed
  ///         this keyframe over (people who stand would be in it): counted
  std::optional<DenseInput> gather(KeyframeId id, Stamp stamp, KeyframeImages images, const LabelSet& labels);

  std::string missing() const { return frames_.missing(); }
  void report(StageDiagnostics& diagnostics, StageDiagnostics::Status& status) const;
  /// Ends all subscriptions and waiting, for good. Not during missing().
  void close();

 private:
  bool motionRuns() const { return mask_subscriber_.getNumPublishers() > 0; }
  bool networkRuns() const { return labels_subscriber_.getNumPublishers() > 0; }
  cv::Mat1b withMovingObjects(const cv::Mat1b& mask, const cv::Mat1b& labels, const LabelSet& label_set) const;

  const KeyframeInputsConfig config_;
  StampedBuffer<cv::Mat1b> masks_{30};
  // Of as many keyframes as may wait for the map; k1 is named after later frames have been labelled.
  StampedBuffer<cv::Mat1b> labels_{64, 2.0};
  std::atomic<std::size_t> masks_missing_{0}, unlabelled_{0};

  // Last, so that callbacks stop before what they use is gone.
  ros::Subscriber mask_subscriber_, labels_subscriber_;
  KeptFrames frames_;
};

}  // namespace semantic_vslam
