// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/node_configs.h"

#include <set>

#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {

std::vector<std::pair<std::string, std::string>> readConfigFileFor(const std::vector<ConfigEntry>& known,
                                                                   const std::string& path) {
  std::set<std::string> known_keys;
  for (const ConfigEntry& entry : known) known_keys.insert(entry.key);
  AnyConfig any;
  std::vector<std::pair<std::string, std::string>> entries;
  try {
    for (auto& [key, value] : readConfigFile(path)) {
      setConfig(any, key, value);
      if (known_keys.count(key) > 0) entries.emplace_back(key, value);
    }
  } catch (const ConfigError& error) {
    throw ConfigError("configuration file '" + path + "': " + error.what());
  }
  return entries;
}

}  // namespace semantic_vslam
