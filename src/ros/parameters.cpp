// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/parameters.h"

#include <XmlRpcValue.h>

#include <set>
#include <sstream>

#include "semantic_vslam/core/common/error.h"
#include "semantic_vslam/core/pipeline/config.h"

namespace semantic_vslam {
namespace {

using Entries = std::vector<std::pair<std::string, std::string>>;

/// Names that belong to ROS or to the loader itself. `thresholds` is where dynamic_reconfigure mirrors its values, as
/// do the image transports under their own names.
const std::set<std::string> kReserved = {"config_file",
                                         "restarted",
                                         "thresholds",
                                         "diagnostic_period",
                                         "image_transport",
                                         "depth_image_transport",
                                         "bond_disable_heartbeat_timeout",
                                         "compressed",
                                         "compressedDepth",
                                         "theora"};

std::string topLevel(const std::string& key) { return key.substr(0, key.find('.')); }

/// Scalar of the parameter server as text that the described config parses. Doubles keep all their digits.
std::string scalarText(const std::string& key, XmlRpc::XmlRpcValue& value) {
  std::ostringstream out;
  out.precision(17);
  switch (value.getType()) {
    case XmlRpc::XmlRpcValue::TypeBoolean: return static_cast<bool>(value) ? "true" : "false";
    case XmlRpc::XmlRpcValue::TypeInt: out << static_cast<int>(value); return out.str();
    case XmlRpc::XmlRpcValue::TypeDouble: out << static_cast<double>(value); return out.str();
    case XmlRpc::XmlRpcValue::TypeString: return static_cast<std::string>(value);
    default: throw ConfigError("parameter '~" + key + "' must be a single value or a map");
  }
}

void flatten(const std::string& prefix, XmlRpc::XmlRpcValue& node, Entries& out) {
  for (auto& [name, value] : node) {
    const std::string key = config_detail::joinKey(prefix, name);
    if (kReserved.count(topLevel(key)) > 0) continue;
    if (value.getType() == XmlRpc::XmlRpcValue::TypeStruct) {
      flatten(key, value, out);
    } else {
      out.emplace_back(key, scalarText(key, value));
    }
  }
}

}  // namespace

Entries readPrivateParameters(const ros::NodeHandle& private_nh) {
  Entries entries;
  XmlRpc::XmlRpcValue root;
  if (private_nh.getParam(private_nh.getNamespace(), root) && root.getType() == XmlRpc::XmlRpcValue::TypeStruct) {
    flatten("", root, entries);
  }
  return entries;
}

Entries readConfigFileFor(const std::vector<ConfigEntry>& known, const std::string& path) {
  std::set<std::string> known_keys;
  for (const ConfigEntry& entry : known) known_keys.insert(entry.key);
  SystemConfig whole;
  Entries entries;
  for (auto& [key, value] : readConfigFile(path)) {
    setConfig(whole, key, value);
    if (known_keys.count(key) > 0) entries.emplace_back(key, value);
  }
  return entries;
}

}  // namespace semantic_vslam
