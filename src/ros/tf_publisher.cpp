// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/tf_publisher.h"

#include <ros/console.h>

#include <chrono>
#include <cmath>
#include <thread>

#include "ros/conversions.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

constexpr std::chrono::milliseconds kPollPeriod{2};  // a fraction of what a frame takes
// Odometry comes within tens of milliseconds; over a network or a filter within tenths of a second.
constexpr double kOdometryBehindS = 0.5;

}  // namespace

TfPublisher::TfPublisher(ros::NodeHandle nh, const FramesConfig& config)
    : config_(config), parents_(frameName(config.map_frame)) {
  if (config_.map_frame.empty()) throw ConfigError("frames.map_frame is empty, must name the fixed frame");
  if (!config_.odom_frame.empty() && config_.base_frame.empty()) {
    throw ConfigError("frames.odom_frame is '" + config_.odom_frame +
                      "' but frames.base_frame is empty; map -> odom needs both");
  }
  if (config_.map_frame == config_.odom_frame || config_.map_frame == config_.base_frame ||
      (!config_.odom_frame.empty() && config_.odom_frame == config_.base_frame)) {
    throw ConfigError("frames.map_frame, odom_frame and base_frame must differ (REP 105)");
  }
  if (config_.publish_tf) {
    const auto take = [this](const tf2_msgs::TFMessageConstPtr& message) { parents_.take(*message); };
    tf_subscriber_ = nh.subscribe<tf2_msgs::TFMessage>("/tf", 100, take);
    static_subscriber_ = nh.subscribe<tf2_msgs::TFMessage>("/tf_static", 100, take);
  }
  if (config_.base_frame.empty()) return;
  buffer_ = std::make_unique<tf2_ros::Buffer>();
  if (config_.publish_tf && !config_.odom_frame.empty()) {
    correction_.emplace(*buffer_, config_.odom_frame, config_.base_frame);
    tf_changes_ = buffer_->_addTransformsChangedListener([this] { onTfChange(); });
  }
  listener_ = std::make_unique<tf2_ros::TransformListener>(*buffer_, nh);
}

TfPublisher::~TfPublisher() {
  listener_.reset();  // ends its thread, which calls this object
  tf_changes_.disconnect();
}

std::string TfPublisher::bodyFrame(const std_msgs::Header& image) const {
  return config_.base_frame.empty() ? frameName(image.frame_id) : config_.base_frame;
}

std::optional<SE3> TfPublisher::lookUpBody(const std_msgs::Header& image) {
  const std::string camera_frame = frameName(image.frame_id);
  if (config_.base_frame.empty() || config_.base_frame == camera_frame) return SE3::Identity();
  // tf2's own waiting goes by simulated time, which may stand still.
  const auto deadline =
      std::chrono::steady_clock::now() + std::chrono::microseconds(std::lround(config_.tf_wait_s * 1e6));
  while (mount_known_ && !buffer_->canTransform(camera_frame, config_.base_frame, image.stamp) &&
         std::chrono::steady_clock::now() < deadline) {
    std::this_thread::sleep_for(kPollPeriod);
  }
  try {
    const SE3 T_camera_body =
        fromRos(buffer_->lookupTransform(camera_frame, config_.base_frame, image.stamp).transform);
    mount_known_ = true;
    return T_camera_body;
  } catch (const tf2::TransformException& error) {
    mount_known_ = false;
    const std::lock_guard<std::mutex> lock(mutex_);
    fail(camera_frame + " -> " + config_.base_frame, std::string(error.what()) + "; the frame is skipped");
    return std::nullopt;
  }
}

void TfPublisher::publish(const std_msgs::Header& image, const SE3& T_map_body) {
  if (!config_.publish_tf) return;
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!correction_) {
    send(bodyFrame(image), image.stamp, T_map_body);
    return;
  }
  if (const auto edge = correction_->add(image.stamp, T_map_body)) sendOdometry(*edge);
  if (correction_->behindS() > kOdometryBehindS) {
    fail(config_.odom_frame + " -> " + config_.base_frame,
         "not there for the images' time, nor some time later; map -> odom stays as it was last");
  }
}

/// On the listener's thread.
void TfPublisher::onTfChange() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (const auto edge = correction_->update()) sendOdometry(*edge);
}

void TfPublisher::sendOdometry(const OdometryCorrection::Edge& edge) {
  send(config_.odom_frame, edge.stamp + ros::Duration(config_.tf_future_s), edge.T_map_odom);
}

/// Call with mutex_ held.
void TfPublisher::fail(const std::string& edge, const std::string& reason) {
  ++failed_lookups_;
  last_failure_ = edge + ": " + reason;
  if (throttle_.passes(edge)) ROS_WARN("tf: %s", last_failure_.c_str());
}

std::string TfPublisher::lastFailure() const {
  std::lock_guard<std::mutex> lock(mutex_);
  return last_failure_;
}

std::string TfPublisher::lastWithheld() const {
  std::lock_guard<std::mutex> lock(mutex_);
  return last_withheld_;
}

/// Call with mutex_ held.
bool TfPublisher::wouldCut(const std::string& child) {
  const std::string parent = parents_.of(child);
  if (parent.empty()) return false;
  ++withheld_;
  last_withheld_ = "'" + child + "' hangs below '" + parent +
                   "', and would be cut from it: name the root of the robot's "
                   "tree (its body, or the camera's own root) as base_frame, and its odometry, if any, as odom_frame";
  if (throttle_.passes(last_withheld_)) {
    ROS_WARN("tf: %s -> %s is not sent: %s", config_.map_frame.c_str(), child.c_str(), last_withheld_.c_str());
  }
  return true;
}

/// Call with mutex_ held.
void TfPublisher::send(const std::string& child, const ros::Time& stamp, const SE3& T_map_child) {
  if (stamp == last_sent_ || wouldCut(child)) return;  // tf2 warns of repeated data
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
