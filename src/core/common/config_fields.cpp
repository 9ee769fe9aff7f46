// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "semantic_vslam/core/common/config_fields.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>
#include <numeric>
#include <set>
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

std::string leafOf(const std::string& key) { return key.substr(key.rfind('.') + 1); }

/// Letters that differ between two words (Levenshtein's distance).
std::size_t distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, diagonal + 1, row[j] + 1});
    }
  }
  return row.back();
}

/// @return the keys of the same last name, nearest first; else those that a slip of the pen leads to; else ""
std::string suggestion(const std::string& key, const std::vector<ConfigEntry>& known) {
  constexpr std::size_t kSlip = 3, kMost = 3;
  std::set<std::pair<std::size_t, std::string>> same, near;
  for (const ConfigEntry& entry : known) {
    const std::size_t letters = distance(entry.key, key);
    if (leafOf(entry.key) == leafOf(key)) same.emplace(letters, entry.key);
    const std::size_t of_leaf = distance(leafOf(entry.key), leafOf(key));
    // A third of the word may be wrong at most: short words are all alike.
    if (std::min(letters, of_leaf) <= std::min(kSlip, leafOf(key).size() / 3)) near.emplace(letters, entry.key);
  }
  std::string hint;
  std::size_t named = 0;
  for (const auto& [letters, name] : same.empty() ? near : same) {
    if (++named <= kMost) hint += (hint.empty() ? "" : ", ") + name;
  }
  return hint;
}

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
  const std::string group = key.substr(0, key.find('.'));
  for (const auto& [old_name, name] : kRenamedGroups) {
    if (group != old_name) continue;
    throw ConfigError("configuration key '" + key + "' is now '" + name + key.substr(group.size()) + "'");
  }
  const std::string hint = suggestion(key, known);
  throw ConfigError("unknown configuration key '" + key + "'" +
                    (hint.empty() ? "; --list-config prints all keys" : "; did you mean " + hint + "?"));
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

std::string describe(const std::vector<ConfigEntry>& entries) {
  std::ostringstream out;
  out << std::left;
  for (const ConfigEntry& entry : entries) {
    out << std::setw(45) << entry.key << ' ' << std::setw(14) << (entry.value.empty() ? "\"\"" : entry.value) << ' '
        << entry.bounds << (entry.bounds.empty() ? "" : "  ") << entry.documentation << '\n';
  }
  return out.str();
}

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
