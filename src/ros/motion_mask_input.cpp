// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/motion_mask_input.h"

#include <ros/console.h>

#include <chrono>

#include "ros/conversions.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {

MotionMaskInput::MotionMaskInput(ros::NodeHandle nh, const MotionMaskConfig& config) : config_(config) {
  mask_subscriber_ = nh.subscribe("motion/mask", 10, &MotionMaskInput::onMask, this);
  if (config_.init_wait_s > 0) {
    report_subscriber_ = nh.subscribe("motion/report", 10, &MotionMaskInput::onReport, this);
    labels_subscriber_ = nh.subscribe<sensor_msgs::Image>("segmentation/labels", 2, [this](const auto&) {
      std::lock_guard<std::mutex> lock(mutex_);
      network_seen_ = true;
    });
  }
}

void MotionMaskInput::onMask(const sensor_msgs::ImageConstPtr& message) {
  try {
    masks_.put(fromRos(message->header.stamp), maskFromRos(message));
  } catch (const Error& error) {
    ROS_ERROR_THROTTLE(5.0, "mask refused: %s", error.what());
  }
}

void MotionMaskInput::onReport(const MotionReportConstPtr& message) {
  std::lock_guard<std::mutex> lock(mutex_);
  const bool labelled = !message->labels.isZero();
  labelled_.add(fromRos(message->header.stamp),
                labelled ? std::optional<Stamp>(fromRos(message->labels)) : std::nullopt);
}

bool MotionMaskInput::readyToStart(Stamp stamp, bool has_mask) {
  if (config_.init_wait_s <= 0) return true;
  std::lock_guard<std::mutex> lock(mutex_);
  if (has_mask && labelled_.at(stamp)) return true;
  if (network_seen_ && labels_subscriber_.getNumPublishers() == 0) return true;  // it broke down
  const ros::SteadyTime now = ros::SteadyTime::now();
  if (!waiting_since_) waiting_since_ = now;
  if ((now - *waiting_since_).toSec() < config_.init_wait_s) return false;
  ROS_WARN_ONCE("no labels within init_wait_s: starting without");
  return true;
}

void MotionMaskInput::restart() {
  std::lock_guard<std::mutex> lock(mutex_);
  labelled_.restart();
  waiting_since_.reset();
}

cv::Mat1b MotionMaskInput::maskOf(const std_msgs::Header& image, cv::Size size) {
  const std::chrono::milliseconds budget(mask_subscriber_.getNumPublishers() > 0 ? config_.mask_budget_ms : 0);
  const cv::Mat1b mask = masks_.waitFor(fromRos(image.stamp), budget).value_or(cv::Mat1b());
  if (mask.empty() || mask.size() == size) return mask;
  ROS_ERROR_THROTTLE(5.0, "motion/mask is %dx%d but the image %dx%d: tracked without", mask.cols, mask.rows, size.width,
                     size.height);
  return cv::Mat1b();
}

void MotionMaskInput::close() {
  mask_subscriber_.shutdown();
  report_subscriber_.shutdown();
  labels_subscriber_.shutdown();
  masks_.close();
}

}  // namespace semantic_vslam
