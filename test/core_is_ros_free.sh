#!/bin/sh
# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
# Fails, naming the line, if a file of the core includes a ROS header. usage: core_is_ros_free.sh REPOSITORY
cd "$1" || exit 1
ros_header='^[[:space:]]*#[[:space:]]*include[[:space:]]*[<"]([a-z0-9_]+_msgs/|ros/|rosbag/|nodelet/|tf2|cv_bridge|image_transport|semantic_vslam/ros/)'
if grep -rnE "$ros_header" src/core include/semantic_vslam/core; then
  echo "the core must stay free of ROS: move this to src/ros"
  exit 1
fi
