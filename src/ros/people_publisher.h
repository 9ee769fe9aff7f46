// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>
#include <std_msgs/Header.h>

#include <string>

#include "core/people/mover_detection.h"
#include "core/people/mover_tracker.h"
#include "semantic_vslam/core/camera/rgbd_frame.h"
#include "semantic_vslam/core/geometry/se3.h"

namespace semantic_vslam {

/// Publishes what is kept out of the map, for planners: people (who and where), people_markers (the same for rviz) and
/// dynamic_cloud (its points, for an obstacle layer). Costs nothing while nobody listens.
class PeoplePublisher {
 public:
  /// @throws ConfigError
  PeoplePublisher(ros::NodeHandle nh, const PeopleConfig& config, const std::string& map_frame);

  /// @param dynamic  MotionResult::dynamic of the frame, or empty: then nothing is published
  void publish(const std_msgs::Header& image, const RgbdFrame& frame, const cv::Mat1b& dynamic,
               const SE3& T_map_camera);

 private:
  const PeopleConfig config_;
  const std::string map_frame_;
  MoverTracker tracker_;
  ros::Publisher people_, markers_, cloud_;
};

}  // namespace semantic_vslam
