// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>
#include <ros/service_server.h>

#include <functional>
#include <string>
#include <vector>

namespace semantic_vslam {

/// The services of one nodelet. What an action throws as Error becomes the answer `success: false` with its message.
class Services {
 public:
  /// std_srvs/Trigger. @param action  returns the answer's message
  void addTrigger(ros::NodeHandle nh, const std::string& name, std::function<std::string()> action);
  /// std_srvs/SetBool.
  void addSwitch(ros::NodeHandle nh, const std::string& name, std::function<void(bool)> action);
  /// Returns when no call is under way any more.
  void shutdown();

 private:
  std::vector<ros::ServiceServer> servers_;
};

}  // namespace semantic_vslam
