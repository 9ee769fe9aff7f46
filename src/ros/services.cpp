// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/services.h"

#include <ros/console.h>
#include <std_srvs/SetBool.h>
#include <std_srvs/Trigger.h>

#include <boost/function.hpp>
#include <utility>

#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {

void Services::addTrigger(ros::NodeHandle nh, const std::string& name, std::function<std::string()> action) {
  using std_srvs::Trigger;
  const boost::function<bool(Trigger::Request&, Trigger::Response&)> callback =
      [action = std::move(action)](Trigger::Request&, Trigger::Response& response) {
        try {
          response.message = action();
          response.success = true;
        } catch (const Error& error) {
          response.message = error.what();
          ROS_ERROR("%s", error.what());
        }
        return true;
      };
  servers_.push_back(nh.advertiseService<Trigger::Request, Trigger::Response>(name, callback));
}

void Services::addSwitch(ros::NodeHandle nh, const std::string& name, std::function<void(bool)> action) {
  using std_srvs::SetBool;
  const boost::function<bool(SetBool::Request&, SetBool::Response&)> callback =
      [action = std::move(action)](SetBool::Request& request, SetBool::Response& response) {
        action(request.data);
        response.success = true;
        return true;
      };
  servers_.push_back(nh.advertiseService<SetBool::Request, SetBool::Response>(name, callback));
}

void Services::shutdown() {
  for (ros::ServiceServer& server : servers_) server.shutdown();
}

}  // namespace semantic_vslam
