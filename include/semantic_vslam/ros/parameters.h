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

/// Sets a described config from, in this order: its defaults, the sections of the YAML file in `~config_file` whose
/// names this config has, and the private parameters. A key `motion.theta` is the parameter `~motion/theta`.
/// A file section of another stage is passed over, so that one file serves all nodelets and the offline tool.
/// @throws ConfigError naming an unknown key, a wrong type or a value out of range; FileError for the file.
template <class Config>
Config loadParameters(const ros::NodeHandle& private_nh);

/// @return the entries of a config file that belong to one of the config's top-level sections.
std::vector<std::pair<std::string, std::string>> readConfigSections(const std::string& path,
                                                                    const std::vector<ConfigEntry>& known);

template <class Config>
Config loadParameters(const ros::NodeHandle& private_nh) {
  Config config;
  std::string config_file;
  private_nh.getParam("config_file", config_file);
  if (!config_file.empty()) {
    for (const auto& [key, value] : readConfigSections(config_file, listConfig(config))) setConfig(config, key, value);
  }
  for (const auto& [key, value] : readPrivateParameters(private_nh)) setConfig(config, key, value);
  return config;
}

}  // namespace semantic_vslam
