// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/motion_input.h"

#include <ros/console.h>

#include <optional>
#include <utility>

#include "ros/conversions.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {

MotionInput::MotionInput(ros::NodeHandle nh, std::function<void(Stamp, const MotionResult&)> sink)
    : sink_(std::move(sink)) {
  report_subscriber_ = nh.subscribe("motion/report", 10, &MotionInput::onReport, this);
  mask_subscriber_ = nh.subscribe("motion/mask", 10, &MotionInput::onMask, this);
}

void MotionInput::onMask(const sensor_msgs::ImageConstPtr& message) {
  const Stamp stamp = fromRos(message->header.stamp);
  try {
    std::lock_guard<std::mutex> lock(mutex_);
    masks_.put(stamp, maskFromRos(message));
  } catch (const Error& error) {
    ROS_ERROR_THROTTLE(5.0, "mask refused: %s", error.what());
    return;
  }
  passOn(stamp);
}

void MotionInput::onReport(const MotionReportConstPtr& message) {
  const Stamp stamp = fromRos(message->header.stamp);
  {
    std::lock_guard<std::mutex> lock(mutex_);
    reports_.put(stamp, message);
  }
  passOn(stamp);
}

/// Each comes on a topic of its own, in no fixed order.
void MotionInput::passOn(Stamp stamp) {
  std::optional<MotionReportConstPtr> report;
  std::optional<cv::Mat1b> mask;
  {
    std::lock_guard<std::mutex> lock(mutex_);
    report = reports_.find(stamp);
    mask = masks_.find(stamp);
  }
  if (!report || !mask) return;
  try {
    MotionResult motion = fromRos(**report);
    motion.dynamic = *mask;
    sink_(stamp, motion);
  } catch (const Error& error) {
    ROS_ERROR_THROTTLE(5.0, "motion report refused: %s", error.what());
  }
}

void MotionInput::shutdown() {
  mask_subscriber_.shutdown();
  report_subscriber_.shutdown();
}

}  // namespace semantic_vslam
