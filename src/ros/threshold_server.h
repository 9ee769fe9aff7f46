// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dynamic_reconfigure/Config.h>
#include <dynamic_reconfigure/server.h>
#include <ros/node_handle.h>

#include <boost/thread/recursive_mutex.hpp>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "semantic_vslam/core/common/config_fields.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {

/// dynamic_reconfigure for some numeric keys of a described config, under `~thresholds`. A reconfigurable parameter
/// `motion__rigid__flow_sigma_px` is the key `motion.rigid.flow_sigma_px`. New values pass the same checks as those of
/// a file; a refused set is written back as it was. Defaults and bounds are those of the config.
template <class Reconfigure, class Config>
class ThresholdServer {
 public:
  /// @param apply  called from the callback thread with each accepted config that differs; it swaps it in between
  /// frames
  ThresholdServer(const ros::NodeHandle& private_nh, const Config& initial, std::function<void(const Config&)> apply)
      : current_(initial), apply_(std::move(apply)), server_(mutex_, ros::NodeHandle(private_nh, "thresholds")) {
    Reconfigure values;
    toReconfigure(current_, values);
    server_.updateConfig(values);  // what the parameters say, not what an earlier run left under ~thresholds
    server_.setCallback([this](Reconfigure& requested, std::uint32_t) { onRequest(requested); });
  }

 private:
  static std::string keyOf(std::string name) {
    for (std::size_t at = name.find("__"); at != std::string::npos; at = name.find("__")) name.replace(at, 2, ".");
    return name;
  }

  static void toReconfigure(const Config& config, Reconfigure& values) {
    dynamic_reconfigure::Config message;
    values.__toMessage__(message);
    const auto textOf = [entries = listConfig(config)](const std::string& key) {
      for (const ConfigEntry& entry : entries) {
        if (entry.key == key) return entry.value;
      }
      throw ConfigError("reconfigurable parameter '" + key + "' is no configuration key");
    };
    for (auto& item : message.ints) item.value = std::stoi(textOf(keyOf(item.name)));
    for (auto& item : message.doubles) item.value = std::stod(textOf(keyOf(item.name)));
    values.__fromMessage__(message);
  }

  static std::vector<std::string> valuesOf(const Config& config) {
    std::vector<std::string> values;
    for (const ConfigEntry& entry : listConfig(config)) values.push_back(entry.value);
    return values;
  }

  void onRequest(Reconfigure& requested) {
    dynamic_reconfigure::Config message;
    requested.__toMessage__(message);
    Config candidate = current_;
    try {
      for (const auto& item : message.ints) setConfig(candidate, keyOf(item.name), config_detail::toText(item.value));
      for (const auto& item : message.doubles)
        setConfig(candidate, keyOf(item.name), config_detail::toText(item.value));
      if (valuesOf(candidate) == valuesOf(current_)) return;
      apply_(candidate);
      current_ = candidate;
    } catch (const ConfigError& error) {
      ROS_ERROR("thresholds refused, the old ones stay: %s", error.what());
      toReconfigure(current_, requested);
    }
  }

  Config current_;  // callback thread only
  const std::function<void(const Config&)> apply_;
  boost::recursive_mutex mutex_;
  dynamic_reconfigure::Server<Reconfigure> server_;
};

}  // namespace semantic_vslam
