// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>
#include <std_msgs/Header.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_broadcaster.h>
#include <tf2_ros/transform_listener.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "ros/log_throttle.h"
#include "ros/node_configs.h"
#include "semantic_vslam/core/geometry/se3.h"

namespace semantic_vslam {

/// What tf says of the body at the stamp of an image.
struct BodyTransforms {
  SE3 T_camera_body = SE3::Identity();  ///< from the camera's optical frame
  std::optional<SE3> T_body_odom;       ///< only where map -> odom is published
};

/// Turns camera poses into the robot's transform tree. One edge, one broadcaster: map -> odom if an odometry frame is
/// set, else map -> base, else map -> camera. Where a look-up fails nothing is sent: no identity is ever made up.
class TfPublisher {
 public:
  /// @throws ConfigError if odom_frame is set without base_frame or frames are named alike.
  TfPublisher(ros::NodeHandle nh, const FramesConfig& config);

  /// @param image  header of the image: stamp, and frame_id of the camera's optical frame
  /// @return child frame of odometry: base_frame, or the camera's frame where there is none.
  std::string bodyFrame(const std_msgs::Header& image) const;

  /// Asks tf for the image's stamp, as the mount may move; waits as configured, by the steady clock. One thread.
  /// @return nothing if tf does not know where the body is in the camera; each look-up that fails is counted
  std::optional<BodyTransforms> lookUp(const std_msgs::Header& image);

  /// Broadcasts the one edge; for map -> odom, nothing if tf did not know odom -> base.
  void publish(const std_msgs::Header& image, const SE3& T_map_body, const std::optional<SE3>& T_body_odom);

  std::size_t sent() const { return sent_; }
  std::size_t failedLookups() const { return failed_lookups_; }
  /// @return what tf did not know last: the two frames and why
  std::string lastFailure() const;

 private:
  using Deadline = std::chrono::steady_clock::time_point;
  std::optional<SE3> find(const std::string& target, const std::string& source, const ros::Time& time,
                          Deadline deadline);
  void warnOfOtherParent(const std::string& child) const;
  void send(const std::string& child, const ros::Time& stamp, const SE3& T_map_child);

  const FramesConfig config_;
  std::unique_ptr<tf2_ros::Buffer> buffer_;  // only where look-ups are needed
  std::unique_ptr<tf2_ros::TransformListener> listener_;
  tf2_ros::TransformBroadcaster broadcaster_;
  ros::Time last_sent_;
  std::atomic<std::size_t> sent_{0}, failed_lookups_{0};
  LogThrottle throttle_;
  mutable std::mutex mutex_;
  std::string last_failure_;  // guarded by mutex_
};

}  // namespace semantic_vslam
