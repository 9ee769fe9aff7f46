// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "semantic_vslam/ros/tf_publisher.h"

#include <ros/console.h>

#include "semantic_vslam/core/common/error.h"
#include "semantic_vslam/ros/conversions.h"

namespace semantic_vslam {

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

std::optional<SE3> TfPublisher::cameraFromBody(const std_msgs::Header& image) {
  const std::string camera_frame = frameName(image.frame_id);
  if (config_.base_frame.empty() || config_.base_frame == camera_frame) return SE3(SE3::Identity());
  return lookUp(camera_frame, config_.base_frame, image.stamp);
}

void TfPublisher::publish(const std_msgs::Header& image, const SE3& T_map_body) {
  if (!config_.publish_tf) return;
  if (config_.odom_frame.empty()) {
    send(bodyFrame(image), image.stamp, T_map_body);
  } else if (const auto T_base_odom = lookUp(config_.base_frame, config_.odom_frame, image.stamp)) {
    send(config_.odom_frame, image.stamp + ros::Duration(config_.tf_future_s), T_map_body * *T_base_odom);
  }
}

std::optional<SE3> TfPublisher::lookUp(const std::string& target, const std::string& source, const ros::Time& time) {
  try {
    return fromRos(buffer_->lookupTransform(target, source, time, ros::Duration(config_.tf_wait_s)).transform);
  } catch (const tf2::TransformException& error) {
    ++failed_lookups_;
    ROS_WARN_THROTTLE(5.0, "tf of this frame skipped: %s -> %s: %s", target.c_str(), source.c_str(), error.what());
    return std::nullopt;
  }
}

void TfPublisher::send(const std::string& child, const ros::Time& stamp, const SE3& T_map_child) {
  if (stamp == last_sent_) return;  // tf2 warns of repeated data
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
