// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/parameters.h"

#include <XmlRpcValue.h>
#include <ros/console.h>

#include <set>
#include <sstream>

#include "semantic_vslam/core/common/error.h"

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

void warnOfOverridden(const std::string& path, const std::vector<ConfigEntry>& file,
                      const std::vector<ConfigEntry>& parameters) {
  std::set<std::string> in_file;
  for (const auto& [key, value] : readConfigFile(path)) in_file.insert(key);
  for (std::size_t i = 0; i < file.size(); ++i) {  // both list the same keys
    const auto& [key, value, bounds, documentation] = parameters[i];
    if (value == file[i].value || in_file.count(key) == 0) continue;
    ROS_WARN("'%s' says %s: %s, but the parameter or launch argument says '%s' and holds", path.c_str(), key.c_str(),
             file[i].value.c_str(), value.c_str());
  }
}

}  // namespace semantic_vslam
