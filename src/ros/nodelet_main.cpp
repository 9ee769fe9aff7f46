// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/nodelet_main.h"

#include <nodelet/loader.h>
#include <ros/ros.h>

#include <cstdlib>

namespace semantic_vslam {

int runNodelet(int argc, char** argv, const std::string& node_name, const std::string& nodelet) {
  ros::init(argc, argv, node_name);
  // scripts/respawn says so: it looks for what the process before left.
  if (std::getenv("SEMANTIC_VSLAM_RESTARTED") != nullptr) ros::param::set("~restarted", true);
  nodelet::Loader loader(false);
  const nodelet::V_string arguments(argv + 1, argv + argc);
  if (!loader.load(ros::this_node::getName(), nodelet, ros::names::getRemappings(), arguments)) return 1;
  ros::spin();
  return 0;
}

}  // namespace semantic_vslam
