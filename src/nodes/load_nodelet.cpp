// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
// Keeps one nodelet loaded in a manager: loads it again when the manager was started again, unloads it at its own end.
// `nodelet load` does this with a bond, whose heartbeats a busy machine misses: it would unload stages that only wait.
#include <nodelet/NodeletList.h>
#include <nodelet/NodeletLoad.h>
#include <nodelet/NodeletUnload.h>
#include <ros/ros.h>

#include <algorithm>
#include <csignal>
#include <string>
#include <utility>

namespace {

const ros::WallDuration kLookEvery(0.5);
const ros::WallDuration kWarnAfter(5.0);

/// roscpp's own handler would close the connections that unloading needs.
volatile std::sig_atomic_t stopping = 0;
void stop(int) { stopping = 1; }
bool running() { return stopping == 0 && ros::ok(); }

class Manager {
 public:
  explicit Manager(const std::string& name) : name_(ros::names::resolve(name)) {}

  const std::string& name() const { return name_; }
  bool isThere() const { return ros::service::exists(name_ + "/load_nodelet", false); }

  bool load(const std::string& nodelet, const std::string& type) const {
    nodelet::NodeletLoad load;
    load.request.name = nodelet;
    load.request.type = type;
    for (const auto& [from, to] : ros::names::getRemappings()) {
      load.request.remap_source_args.push_back(from);
      load.request.remap_target_args.push_back(to);
    }
    return ros::service::call(name_ + "/load_nodelet", load);
  }

  /// A manager that is there and does not answer is busy.
  bool has(const std::string& nodelet) const {
    nodelet::NodeletList list;
    if (!ros::service::call(name_ + "/list", list)) return isThere();
    const auto& names = list.response.nodelets;
    return std::find(names.begin(), names.end(), nodelet) != names.end();
  }

  void unload(const std::string& nodelet) const {
    nodelet::NodeletUnload unload;
    unload.request.name = nodelet;
    ros::service::call(name_ + "/unload_nodelet", unload);
  }

 private:
  std::string name_;
};

void waitFor(const Manager& manager, const std::string& nodelet) {
  const ros::WallTime start = ros::WallTime::now();
  bool warned = false;
  while (running() && !manager.isThere()) {
    if (!warned && ros::WallTime::now() - start > kWarnAfter) {
      ROS_WARN("%s waits for the nodelet manager %s", nodelet.c_str(), manager.name().c_str());
      warned = true;
    }
    kLookEvery.sleep();
  }
}

/// @return exit status
int keepLoaded(const std::string& nodelet, const std::string& type, const Manager& manager) {
  while (true) {
    waitFor(manager, nodelet);
    if (!running()) return 0;
    if (!manager.load(nodelet, type)) {
      kLookEvery.sleep();  // a manager that died in the call takes a moment to be gone
      if (!manager.isThere()) continue;
      ROS_FATAL("%s was not loaded; the manager %s says why", nodelet.c_str(), manager.name().c_str());
      return 1;
    }
    while (running() && manager.has(nodelet)) kLookEvery.sleep();
    if (!running()) {
      manager.unload(nodelet);
      return 0;
    }
    ROS_WARN("%s is gone with the nodelet manager %s; it is loaded again", nodelet.c_str(), manager.name().c_str());
    ros::param::set(nodelet + "/restarted", true);  // it looks for what the one before left
  }
}

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "load_nodelet", ros::init_options::NoSigintHandler);
  if (argc != 3) {
    ROS_FATAL("usage: load_nodelet TYPE MANAGER, of which the nodelet gets this node's name and remappings");
    return 2;
  }
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, stop);
  ros::NodeHandle node;  // keeps the connection to the master
  return keepLoaded(ros::this_node::getName(), argv[1], Manager(argv[2]));
}
