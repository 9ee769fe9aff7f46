// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/time.h>
#include <tf2/buffer_core.h>

#include <deque>
#include <optional>
#include <string>
#include <utility>

#include "semantic_vslam/core/geometry/se3.h"

namespace semantic_vslam {

/// map -> odom, worked out of the body's poses in the map and of the odometry at their stamps, which may come late or
/// stay away. Nobody waits for it: where it comes before the next pose the edge is exact at each stamp; where it comes
/// later, or not at all, the last edge goes on, since odometry drifts little in that time. Not thread-safe.
class OdometryCorrection {
 public:
  struct Edge {
    ros::Time stamp;
    SE3 T_map_odom;
  };

  /// @param tf  what is known of the robot's frames; must outlive this
  OdometryCorrection(const tf2::BufferCore& tf, std::string odom_frame, std::string base_frame)
      : tf_(tf), odom_frame_(std::move(odom_frame)), base_frame_(std::move(base_frame)) {}

  /// A new pose of the body. @return the edge to send now: that of this stamp, or the last one where the odometry of
  /// the
  ///         pose before is still awaited; nothing where there was none yet, or it is to be awaited: see update()
  std::optional<Edge> add(const ros::Time& stamp, const SE3& T_map_body);
  /// To be called when tf has changed. @return the edge of the newest pose, if its odometry has come and no edge of
  ///         its stamp or a newer one was given
  std::optional<Edge> update();

  /// By how much odometry is behind the newest pose, s; 0 where it is there.
  double behindS() const;

 private:
  struct Pose {
    ros::Time stamp;
    SE3 T_map_body;
  };

  const tf2::BufferCore& tf_;
  const std::string odom_frame_, base_frame_;
  std::deque<Pose> waiting_;  ///< for odometry, oldest first
  ros::Time newest_, given_;  ///< pose, and edge
  std::optional<SE3> T_map_odom_;
  std::optional<ros::Time> known_;  ///< newest pose whose odometry was there
  std::optional<ros::Time> first_;  ///< pose of all
};

}  // namespace semantic_vslam
