// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>

#include <string>
#include <utility>
#include <vector>

#include "semantic_vslam/core/common/config_fields.h"

namespace semantic_vslam {

/// All private parameters of a node as (dotted key, value as text), without those that ROS itself keeps there
/// (diagnostics, image transports, bonds) and the `thresholds` of dynamic_reconfigure.
/// @throws ConfigError naming a parameter that is no single value (a list, binary data).
std::vector<std::pair<std::string, std::string>> readPrivateParameters(const ros::NodeHandle& private_nh);

/// Reads a configuration file of the whole system, as the offline tool takes it, and checks all of it.
/// @return the entries that one of `known` names: those of the stages that this nodelet runs.
/// @throws FileError for the file; ConfigError naming a key that no stage has, or that is mistyped or out of range.
std::vector<std::pair<std::string, std::string>> readConfigFileFor(const std::vector<ConfigEntry>& known,
                                                                   const std::string& path);

/// Sets a described config from, in this order: its defaults, the YAML file in `~config_file`, and the private
/// parameters. The key `motion.model` is the parameter `~motion/model`.
/// @throws ConfigError naming an unknown key, a wrong type or a value out of range; FileError for the file.
template <class Config>
Config loadParameters(const ros::NodeHandle& private_nh) {
  Config config;
  std::string config_file;
  private_nh.getParam("config_file", config_file);
  if (!config_file.empty()) {
    for (const auto& [key, value] : readConfigFileFor(listConfig(config), config_file)) setConfig(config, key, value);
  }
  for (const auto& [key, value] : readPrivateParameters(private_nh)) setConfig(config, key, value);
  validateConfig(config);
  return config;
}

}  // namespace semantic_vslam
