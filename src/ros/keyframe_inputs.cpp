// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/keyframe_inputs.h"

#include <ros/console.h>

#include <chrono>
#include <cmath>
#include <utility>

#include "core/labels/dynamic_objects.h"
#include "ros/conversions.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

std::chrono::milliseconds milliseconds(double seconds) { return std::chrono::milliseconds(std::lround(seconds * 1e3)); }

boost::function<void(const sensor_msgs::ImageConstPtr&)> keepIn(StampedBuffer<cv::Mat1b>& buffer) {
  return [&buffer](const sensor_msgs::ImageConstPtr& message) {
    try {
      buffer.put(fromRos(message->header.stamp), maskFromRos(message));
    } catch (const Error& error) {
      ROS_ERROR_THROTTLE(5.0, "mask refused: %s", error.what());
    }
  };
}

}  // namespace

KeyframeInputs::KeyframeInputs(ros::NodeHandle nh, ros::NodeHandle private_nh, const KeyframeInputsConfig& config)
    : config_(config), frames_(nh, private_nh, config.frames) {
  mask_subscriber_ = nh.subscribe<sensor_msgs::Image>("motion/mask", 10, keepIn(masks_));
  labels_subscriber_ = nh.subscribe<sensor_msgs::Image>("segmentation/labels", 5, keepIn(labels_));
}

std::optional<DenseInput> KeyframeInputs::gather(KeyframeId id, Stamp stamp, KeyframeImages images,
                                                 const LabelSet& label_set) {
  if (!images.pair) images.pair = frames_.waitFor(stamp);
  if (!images.pair) return std::nullopt;
  if (!images.mask) images.mask = masks_.waitFor(stamp, milliseconds(motionRuns() ? config_.mask_wait_s : 0.0));
  if (!images.mask) ++masks_missing_;
  const auto labels = labels_.waitFor(stamp, milliseconds(networkRuns() ? config_.labels_wait_s : 0.0));
  if (!labels && networkRuns()) {  // still: a network that broke down meanwhile labels nothing any more
    ++unlabelled_;
    return std::nullopt;
  }
  if (!images.mask && !labels && motionRuns()) return std::nullopt;

  const std::optional<RgbdFrame> frame = frames_.convert(*images.pair);
  if (!frame) return std::nullopt;
  DenseInput input{id, *frame, labels.value_or(cv::Mat1b()), cv::Mat1b()};
  input.dynamic = withMovingObjects(images.mask.value_or(cv::Mat1b()), input.labels, label_set);
  return input;
}

/// Motion as the mask has it, and what eq. (5) removes as a whole: all of a movable object of which enough moves.
cv::Mat1b KeyframeInputs::withMovingObjects(const cv::Mat1b& mask, const cv::Mat1b& labels,
                                            const LabelSet& label_set) const {
  if (labels.empty() || (!mask.empty() && mask.size() != labels.size())) return mask;
  cv::Mat1b removed;
  decideDynamic(labels, label_set, mask, config_.segmentation.phi, &removed);
  return mask.empty() ? removed : cv::Mat1b(cv::max(removed, mask));
}

void KeyframeInputs::report(StageDiagnostics& diagnostics, StageDiagnostics::Status& status) const {
  frames_.report(diagnostics, status);
  status.add("keyframes without mask", masks_missing_.load());
  status.add("keyframes left out for want of labels", unlabelled_.load());
}

void KeyframeInputs::close() {
  mask_subscriber_.shutdown();
  labels_subscriber_.shutdown();
  frames_.close();
  masks_.close();
  labels_.close();
}

}  // namespace semantic_vslam
