// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>

#include <string>
#include <utility>
#include <vector>

#include "ros/node_configs.h"
#include "semantic_vslam/core/common/config_fields.h"

namespace semantic_vslam {

/// All private parameters of a node as (dotted key, value as text), without those that ROS itself keeps there
/// (diagnostics, image transports, bonds) and the `thresholds` of dynamic_reconfigure.
/// @throws ConfigError naming a parameter that is no single value (a list, binary data).
std::vector<std::pair<std::string, std::string>> readPrivateParameters(const ros::NodeHandle& private_nh);

/// Says of every key of the configuration file that a parameter has another value for, which is the one that holds.
/// @param file, parameters  all values after the file, and after the parameters
void warnOfOverridden(const std::string& path, const std::vector<ConfigEntry>& file,
                      const std::vector<ConfigEntry>& parameters);

/// Sets a described config from, in this order: its defaults, the YAML file in `~config_file`, which
/// may hold keys of other nodes too, and the private parameters. The key `motion.model` is the parameter
/// `~motion/model`.
/// @throws ConfigError naming an unknown key, a wrong type or a value out of range; FileError for the file.
template <class Config>
Config loadParameters(const ros::NodeHandle& private_nh) {
  Config config;
  std::string config_file;
  private_nh.getParam("config_file", config_file);
  if (!config_file.empty()) loadSharedConfigFile(config, config_file);
  const Config of_file = config;
  for (const auto& [key, value] : readPrivateParameters(private_nh)) setConfig(config, key, value);
  if (!config_file.empty()) warnOfOverridden(config_file, listConfig(of_file), listConfig(config));
  validateConfig(config);
  return config;
}

}  // namespace semantic_vslam
