// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/tf_publisher.h"

#include <ros/console.h>

#include <cmath>
#include <thread>

#include "ros/conversions.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

constexpr std::chrono::milliseconds kPollPeriod{2};  // a fraction of what a frame takes

}  // namespace

TfPublisher::TfPublisher(ros::NodeHandle nh, const FramesConfig& config) : config_(config) {
  if (config_.map_frame.empty()) throw ConfigError("frames.map_frame is empty, must name the fixed frame");
  if (!config_.odom_frame.empty() && config_.base_frame.empty()) {
    throw ConfigError("frames.odom_frame is '" + config_.odom_frame +
                      "' but frames.base_frame is empty; map -> odom needs both");
  }
  if (config_.map_frame == config_.odom_frame || config_.map_frame == config_.base_frame ||
      (!config_.odom_frame.empty() && config_.odom_frame == config_.base_frame)) {
    throw ConfigError("frames.map_frame, odom_frame and base_frame must differ (REP 105)");
  }
  if (config_.base_frame.empty()) return;
  buffer_ = std::make_unique<tf2_ros::Buffer>();
  listener_ = std::make_unique<tf2_ros::TransformListener>(*buffer_, nh);
}

std::string TfPublisher::bodyFrame(const std_msgs::Header& image) const {
  return config_.base_frame.empty() ? frameName(image.frame_id) : config_.base_frame;
}

std::optional<BodyTransforms> TfPublisher::lookUp(const std_msgs::Header& image) {
  const Deadline deadline =
      std::chrono::steady_clock::now() + std::chrono::microseconds(std::lround(config_.tf_wait_s * 1e6));
  BodyTransforms transforms;
  const std::string camera_frame = frameName(image.frame_id);
  if (!config_.base_frame.empty() && config_.base_frame != camera_frame) {
    const auto T_camera_body = find(camera_frame, config_.base_frame, image.stamp, deadline);
    if (!T_camera_body) return std::nullopt;
    transforms.T_camera_body = *T_camera_body;
  }
  if (config_.publish_tf && !config_.odom_frame.empty()) {
    transforms.T_body_odom = find(config_.base_frame, config_.odom_frame, image.stamp, deadline);
  }
  return transforms;
}

void TfPublisher::publish(const std_msgs::Header& image, const SE3& T_map_body, const std::optional<SE3>& T_body_odom) {
  if (!config_.publish_tf) return;
  if (config_.odom_frame.empty()) {
    send(bodyFrame(image), image.stamp, T_map_body);
  } else if (T_body_odom) {
    send(config_.odom_frame, image.stamp + ros::Duration(config_.tf_future_s), T_map_body * *T_body_odom);
  }
}

/// tf2's own waiting goes by simulated time, which may stand still.
std::optional<SE3> TfPublisher::find(const std::string& target, const std::string& source, const ros::Time& time,
                                     Deadline deadline) {
  while (!buffer_->canTransform(target, source, time) && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::sleep_for(kPollPeriod);
  }
  try {
    return fromRos(buffer_->lookupTransform(target, source, time).transform);
  } catch (const tf2::TransformException& error) {
    ++failed_lookups_;
    const std::string edge = target + " -> " + source;
    if (throttle_.passes(edge)) ROS_WARN("tf of this frame skipped: %s: %s", edge.c_str(), error.what());
    std::lock_guard<std::mutex> lock(mutex_);
    last_failure_ = edge + ": " + error.what();
    return std::nullopt;
  }
}

std::string TfPublisher::lastFailure() const {
  std::lock_guard<std::mutex> lock(mutex_);
  return last_failure_;
}

/// A frame has one parent in tf: who publishes another one takes it away from where it hung.
void TfPublisher::warnOfOtherParent(const std::string& child) const {
  std::string parent;
  if (!buffer_ || !buffer_->_getParent(child, ros::Time(0), parent) || parent == config_.map_frame) return;
  ROS_WARN(
      "tf: '%s' hangs below '%s' already, and is now published below '%s': name the robot's own body as base_frame, "
      "and its odometry as odom_frame if it has one",
      child.c_str(), parent.c_str(), config_.map_frame.c_str());
}

void TfPublisher::send(const std::string& child, const ros::Time& stamp, const SE3& T_map_child) {
  if (stamp == last_sent_) return;  // tf2 warns of repeated data
  if (sent_ == 0) warnOfOtherParent(child);
  geometry_msgs::TransformStamped message;
  message.header.stamp = stamp;
  message.header.frame_id = config_.map_frame;
  message.child_frame_id = child;
  message.transform = toTransform(T_map_child);
  broadcaster_.sendTransform(message);
  last_sent_ = stamp;
  ++sent_;
}

}  // namespace semantic_vslam
