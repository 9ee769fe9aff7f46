// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/nodelet_main.h"

#include <nodelet/loader.h>
#include <ros/ros.h>

#include <cstdio>
#include <cstdlib>

#include "core/common/arguments.h"

namespace semantic_vslam {
namespace {

constexpr const char* kUsage =
    "usage: %PROGRAM% [_KEY:=VALUE ...] [NAME:=NAME ...] [--list-config]\n"
    "One stage of semantic_vslam as a ROS node; launch/slam.launch starts all of them.\n"
    "  _KEY:=VALUE          a private parameter: any key of --list-config, with / for its dots\n"
    "  _config_file:=FILE   YAML with keys of any node and of run_offline; parameters hold over it\n"
    "  _image_transport:=NAME, _depth_image_transport:=NAME   how images come in, raw unless set\n"
    "  NAME:=NAME           a remapping of ROS, __name:= for instance\n"
    "  --list-config        print every key with its default, bounds and meaning\n";

std::string usageOf(const std::string& path) {
  const std::string word = "%PROGRAM%";
  std::string usage = kUsage;
  return usage.replace(usage.find(word), word.size(), path.substr(path.rfind('/') + 1));
}

int load(const std::string& nodelet) {
  // scripts/respawn says so: it looks for what the process before left.
  if (std::getenv("SEMANTIC_VSLAM_RESTARTED") != nullptr) ros::param::set("~restarted", true);
  nodelet::Loader loader(false);
  if (!loader.load(ros::this_node::getName(), nodelet, ros::names::getRemappings(), {})) return 1;
  ros::spin();
  return 0;
}

}  // namespace

int runNodelet(int argc, char** argv, const std::string& node_name, const std::string& nodelet,
               const std::vector<ConfigEntry>& keys) {
  return runTool(argc, argv, usageOf(argv[0]), [&] {
    ros::V_string words;
    ros::removeROSArgs(argc, argv, words);
    std::vector<const char*> others;
    for (const std::string& word : words) others.push_back(word.c_str());
    const Arguments arguments(static_cast<int>(others.size()), others.data(), {}, {"--list-config"}, {});
    if (arguments.has("--list-config")) {
      std::fputs(describe(keys).c_str(), stdout);
      return 0;
    }
    ros::init(argc, argv, node_name);
    return load(nodelet);
  });
}

}  // namespace semantic_vslam
