// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "semantic_vslam/core/common/config_fields.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <utility>

#include "core/common/input_file.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace config_detail {
namespace {

/// Old name, present name: files written for an earlier version are refused with a word on how to mend them.
const std::array<std::pair<std::string, std::string>, 2> kRenamedGroups{
    {{"mapping", "sparse_map"}, {"local_ba", "bundle_adjustment"}}};

}  // namespace

std::string joinKey(const std::string& prefix, const std::string& name) {
  return prefix.empty() ? name : prefix + "." + name;
}

std::string toText(int value) { return std::to_string(value); }

std::string toText(double value) {
  std::ostringstream out;
  out.precision(12);
  out << value;
  return out.str();
}

void checkRange(const std::string& key, double value, double low, double high) {
  if (!(value >= low && value <= high)) {  // also refuses NaN
    throw ConfigError("configuration key '" + key + "' is " + toText(value) + ", must be in [" + toText(low) + ", " +
                      toText(high) + "]");
  }
}

void checkChoice(const std::string& key, const std::string& value, const std::vector<std::string>& allowed) {
  if (std::find(allowed.begin(), allowed.end(), value) != allowed.end()) return;
  std::string words;
  for (const auto& word : allowed) words += (words.empty() ? "" : ", ") + word;
  throw ConfigError("configuration key '" + key + "' is '" + value + "', must be one of " + words);
}

int parseInt(const std::string& key, const std::string& text) {
  std::istringstream in(text);
  int value = 0;
  if (!(in >> value) || !in.eof()) {
    throw ConfigError("configuration key '" + key + "' is '" + text + "', must be a whole number");
  }
  return value;
}

double parseDouble(const std::string& key, const std::string& text) {
  std::istringstream in(text);
  double value = 0.0;
  if (!(in >> value) || !in.eof() || !std::isfinite(value)) {
    throw ConfigError("configuration key '" + key + "' is '" + text + "', must be a finite number");
  }
  return value;
}

bool parseBool(const std::string& key, const std::string& text) {
  if (text == "true" || text == "True" || text == "1") return true;
  if (text == "false" || text == "False" || text == "0") return false;
  throw ConfigError("configuration key '" + key + "' is '" + text + "', must be true or false");
}

void throwUnknownKey(const std::string& key, const std::vector<ConfigEntry>& known) {
  const std::string leaf = key.substr(key.rfind('.') + 1), group = key.substr(0, key.find('.'));
  for (const auto& [old_name, name] : kRenamedGroups) {
    if (group != old_name) continue;
    throw ConfigError("configuration key '" + key + "' is now '" + name + key.substr(group.size()) + "'");
  }
  std::string hint;
  for (const auto& entry : known) {
    if (entry.key.substr(entry.key.rfind('.') + 1) == leaf) hint += (hint.empty() ? "" : ", ") + entry.key;
  }
  throw ConfigError("unknown configuration key '" + key + "'" +
                    (hint.empty() ? "; `run_offline --list-config` prints all keys" : "; did you mean " + hint + "?"));
}

}  // namespace config_detail

namespace {

void flatten(const YAML::Node& node, const std::string& prefix, const std::string& path,
             std::vector<std::pair<std::string, std::string>>& out) {
  for (const auto& item : node) {
    const std::string key = config_detail::joinKey(prefix, item.first.as<std::string>());
    if (item.second.IsMap()) {
      flatten(item.second, key, path, out);
    } else if (item.second.IsScalar() || item.second.IsNull()) {
      out.emplace_back(key, item.second.IsNull() ? "" : item.second.as<std::string>());
    } else {
      throw FileError("configuration file '" + path + "': key '" + key + "' must be a single value or a map");
    }
  }
}

}  // namespace

std::vector<std::pair<std::string, std::string>> readConfigFile(const std::string& path) {
  std::vector<std::pair<std::string, std::string>> values;
  const YAML::Node root = readYamlFile("configuration file", path);
  if (root.IsNull()) return values;
  if (!root.IsMap()) throw FileError("configuration file '" + path + "' must be a YAML map of keys");
  try {
    flatten(root, "", path, values);
  } catch (const YAML::Exception& error) {
    throw FileError("configuration file '" + path + "' has a key that is no text: " + error.what());
  }
  return values;
}

}  // namespace semantic_vslam
