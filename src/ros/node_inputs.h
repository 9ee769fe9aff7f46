// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>

#include <boost/function.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "ros/refusals.h"
#include "ros/rgbd_subscriber.h"
#include "ros/stage_diagnostics.h"

namespace semantic_vslam {

/// Whether anybody publishes a topic that this process subscribes to.
class Published {
 public:
  Published(const ros::NodeHandle& nh, const std::string& topic) : topic_(nh.resolveName(topic)) {}
  bool operator()() const;

 private:
  std::string topic_;
};

/// All by which a nodelet is called: topics, image pairs, services, timers. Each call is under the rule of Refusals.
/// Make it the last member of who is called: when it is destroyed no call is under way any more.
class NodeInputs {
 public:
  explicit NodeInputs(const NodeletHandles& node) : node_(node) {}

  template <class Message, class Callback>
  void topic(const std::string& name, std::uint32_t queue_size, Callback callback) {
    subscribe<Message>(node_.nh, name, queue_size, std::move(callback));
  }
  /// Of a topic whose callback may wait.
  template <class Message, class Callback>
  void waitingTopic(const std::string& name, std::uint32_t queue_size, Callback callback) {
    subscribe<Message>(node_.waiting_nh, name, queue_size, std::move(callback));
  }
  /// The camera. @param sink  must not wait  @throws ConfigError, see RgbdSubscriber
  void images(const RgbdInputConfig& config, RgbdSubscriber::Sink sink);
  /// std_srvs/Trigger below the nodelet's name. @param action  may wait; returns the answer's message. What it throws
  /// becomes the answer `success: false` with its message.
  void trigger(const std::string& name, std::function<std::string()> action);
  /// std_srvs/SetBool likewise.
  void onOff(const std::string& name, std::function<std::string(bool)> action);
  /// Any service below the nodelet's name. @param answer  of (request, response); may wait; what it throws is logged,
  /// and the call fails.
  template <class Service, class Answer>
  void service(const std::string& name, Answer answer) {
    using Request = typename Service::Request;
    using Response = typename Service::Response;
    ros::NodeHandle& nh = node_.waiting_private_nh;
    const boost::function<bool(Request&, Response&)> callback =
        [answer = std::move(answer), resolved = nh.resolveName(name)](Request& request, Response& response) {
          try {
            answer(request, response);
            return true;
          } catch (const std::exception& error) {
            ROS_ERROR("%s: %s", resolved.c_str(), error.what());
            return false;
          }
        };
    services_.push_back(nh.advertiseService<Request, Response>(name, callback));
  }
  /// By the steady clock: a simulated one may stand still.
  void every(double period_s, std::function<void()> action) { timer(node_.nh, period_s, std::move(action)); }
  /// Likewise; the action may wait.
  void everyWaiting(double period_s, std::function<void()> action) {
    timer(node_.waiting_nh, period_s, std::move(action));
  }
  /// Has the nodelet's health reported once a second, with that of these inputs.
  void report(StageDiagnostics& diagnostics, std::function<QueueCounters()> queue,
              std::function<void(StageDiagnostics::Status&)> details);

 private:
  void timer(ros::NodeHandle& nh, double period_s, std::function<void()> action);
  template <class Message, class Callback>
  void subscribe(ros::NodeHandle& nh, const std::string& name, std::uint32_t queue_size, Callback callback) {
    using Pointer = boost::shared_ptr<const Message>;
    const boost::function<void(const Pointer&)> guarded = [this, resolved = nh.resolveName(name),
                                                           callback = std::move(callback)](const Pointer& message) {
      refusals_.guard(resolved, [&] { callback(message); });
    };
    subscribers_.push_back(nh.subscribe<Message>(name, queue_size, guarded));
  }
  template <class Service, class Answer>
  void answered(const std::string& name, Answer answer);

  NodeletHandles node_;
  Refusals refusals_;
  std::unique_ptr<RgbdSubscriber> images_;
  std::vector<ros::Subscriber> subscribers_;
  std::vector<ros::ServiceServer> services_;
  std::vector<ros::SteadyTimer> timers_;  // last: they ask the others
};

}  // namespace semantic_vslam
