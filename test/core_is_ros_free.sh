#!/bin/sh
# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
# Fails, naming the line, if a file of core or eval includes a ROS header. usage: core_is_ros_free.sh REPOSITORY
cd "$1" || exit 1
ros_header='^[[:space:]]*#[[:space:]]*include[[:space:]]*[<"]([a-z0-9_]+_msgs/|ros/|rosbag/|nodelet/|tf2|cv_bridge|image_transport)'
if grep -rnE "$ros_header" src/core src/eval include; then
  echo "core and eval must stay free of ROS: move this to src/ros"
  exit 1
fi
