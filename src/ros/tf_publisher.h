// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>
#include <std_msgs/Header.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_broadcaster.h>
#include <tf2_ros/transform_listener.h>

#include <atomic>
#include <boost/signals2/connection.hpp>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "ros/log_throttle.h"
#include "ros/node_configs.h"
#include "ros/odometry_correction.h"
#include "ros/other_parents.h"
#include "semantic_vslam/core/geometry/se3.h"

namespace semantic_vslam {

/// Turns camera poses into the robot's transform tree. One edge, one broadcaster: map -> odom if an odometry frame is
/// set, else map -> base, else map -> camera. Where a look-up fails nothing is sent: no identity is ever made up. Nor
/// is anything sent that would take a frame from the parent that another node gives it.
class TfPublisher {
 public:
  /// @throws ConfigError if odom_frame is set without base_frame or frames are named alike.
  TfPublisher(ros::NodeHandle nh, const FramesConfig& config);
  ~TfPublisher();

  /// @param image  header of the image: stamp, and frame_id of the camera's optical frame
  /// @return child frame of odometry: base_frame, or the camera's frame where there is none.
  std::string bodyFrame(const std_msgs::Header& image) const;

  /// Asks tf where the body is, from the camera's optical frame, at the image's stamp, as the mount may move; waits as
  /// configured, by the steady clock. One thread.
  /// @return nothing if tf does not know; each look-up that fails is counted
  std::optional<SE3> lookUpBody(const std_msgs::Header& image);

  /// Broadcasts the one edge; map -> odom as OdometryCorrection has it.
  void publish(const std_msgs::Header& image, const SE3& T_map_body);

  std::size_t sent() const { return sent_; }
  std::size_t failedLookups() const { return failed_lookups_; }
  /// @return what tf did not know last: the two frames and why
  std::string lastFailure() const;
  std::size_t withheld() const { return withheld_; }
  /// @return why an edge was not sent; "" if each was
  std::string lastWithheld() const;

 private:
  void onTfChange();
  void fail(const std::string& edge, const std::string& reason);
  void send(const std::string& child, const ros::Time& stamp, const SE3& T_map_child);
  void sendOdometry(const OdometryCorrection::Edge& edge);
  bool wouldCut(const std::string& child);

  const FramesConfig config_;
  OtherParents parents_;
  std::unique_ptr<tf2_ros::Buffer> buffer_;  // only where look-ups are needed
  tf2_ros::TransformBroadcaster broadcaster_;
  std::atomic<std::size_t> sent_{0}, failed_lookups_{0}, withheld_{0};
  bool mount_known_ = true;  // by the last look-up; of the thread that looks up
  mutable std::mutex mutex_;
  std::string last_failure_, last_withheld_;  // guarded by mutex_, as all that follows
  LogThrottle throttle_;
  ros::Time last_sent_;
  std::optional<OdometryCorrection> correction_;
  // Last, so that what they call is still there.
  ros::Subscriber tf_subscriber_, static_subscriber_;
  boost::signals2::connection tf_changes_;
  std::unique_ptr<tf2_ros::TransformListener> listener_;
};

}  // namespace semantic_vslam
