// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/node_inputs.h"

#include <ros/topic_manager.h>
#include <std_srvs/SetBool.h>
#include <std_srvs/Trigger.h>

namespace semantic_vslam {

bool Published::operator()() const { return ros::TopicManager::instance()->getNumPublishers(topic_) > 0; }

void NodeInputs::images(const RgbdInputConfig& config, RgbdSubscriber::Sink sink) {
  images_ = std::make_unique<RgbdSubscriber>(node_.nh, node_.private_nh, config, refusals_, std::move(sink));
}

void NodeInputs::trigger(const std::string& name, std::function<std::string()> action) {
  answered<std_srvs::Trigger>(name,
                              [action = std::move(action)](auto&, auto& response) { response.message = action(); });
}

void NodeInputs::onOff(const std::string& name, std::function<std::string(bool)> action) {
  answered<std_srvs::SetBool>(
      name, [action = std::move(action)](auto& request, auto& response) { response.message = action(request.data); });
}

template <class Service, class Answer>
void NodeInputs::answered(const std::string& name, Answer answer) {
  const std::string resolved = node_.waiting_private_nh.resolveName(name);
  service<Service>(name, [answer = std::move(answer), resolved](auto& request, auto& response) {
    try {
      answer(request, response);
      response.success = true;
    } catch (const std::exception& error) {
      response.message = error.what();
      ROS_ERROR("%s: %s", resolved.c_str(), error.what());
    }
  });
}

void NodeInputs::timer(ros::NodeHandle& nh, double period_s, std::function<void()> action) {
  timers_.push_back(nh.createSteadyTimer(
      ros::WallDuration(period_s),
      [this, action = std::move(action)](const ros::SteadyTimerEvent&) { refusals_.guard("timer", action); }));
}

void NodeInputs::report(StageDiagnostics& diagnostics, std::function<QueueCounters()> queue,
                        std::function<void(StageDiagnostics::Status&)> details) {
  diagnostics.setSources({std::move(queue), [this, &diagnostics, details = std::move(details)](auto& status) {
                            if (images_) images_->report(diagnostics, status);
                            diagnostics.addFault(status, "messages refused", refusals_.count(), refusals_.last());
                            details(status);
                          }});
  every(1.0, [&diagnostics] { diagnostics.report(); });
}

}  // namespace semantic_vslam
