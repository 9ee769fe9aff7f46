// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>
#include <vector>

/// Configuration by description. A stage's config is a struct with defaults and one member function
///
///     template <class Visitor> void visit(Visitor& v) {
///       v.field("features", features, 100, 5000, "ORB features kept per frame");
///       v.choice("model", model, {"homography", "rigid_flow"}, "what explains the camera's own motion");
///       v.flag("enabled", enabled, "false: the stage passes everything as static");
///       v.text("file", file, "network file; empty: no network");
///       v.group("orb", orb);                       // a nested config
///     }
///
/// which is the only list of its keys, bounds, units and documentation. From it come YAML loading, `--set key=value`,
/// ROS parameters, validation and the printed reference. Keys are joined with dots (`tracking.orb.features`).
namespace semantic_vslam {

/// One described key, with its value as text.
struct ConfigEntry {
  std::string key;
  std::string value;
  std::string bounds;         ///< "[100, 5000]", "homography|rigid_flow", "true|false" or ""
  std::string documentation;  ///< what it does, with its unit
};

namespace config_detail {

std::string joinKey(const std::string& prefix, const std::string& name);
std::string toText(int value);
std::string toText(double value);
void checkRange(const std::string& key, double value, double low, double high);
void checkChoice(const std::string& key, const std::string& value, const std::vector<std::string>& allowed);
int parseInt(const std::string& key, const std::string& text);
double parseDouble(const std::string& key, const std::string& text);
bool parseBool(const std::string& key, const std::string& text);

/// What all visitors share: they go into groups, and differ in what they do with one field.
template <class Visitor>
class GroupVisitor {
 public:
  template <class Config>
  void group(const char* name, Config& config) {
    const std::string outer = prefix_;
    prefix_ = joinKey(prefix_, name);
    config.visit(static_cast<Visitor&>(*this));
    prefix_ = outer;
  }

 protected:
  std::string keyOf(const char* name) const { return joinKey(prefix_, name); }

 private:
  std::string prefix_;
};

/// Lists every key.
class Lister : public GroupVisitor<Lister> {
 public:
  std::vector<ConfigEntry> entries;

  void field(const char* name, int& value, int low, int high, const char* documentation) {
    add(name, toText(value), "[" + toText(low) + ", " + toText(high) + "]", documentation);
  }
  void field(const char* name, double& value, double low, double high, const char* documentation) {
    add(name, toText(value), "[" + toText(low) + ", " + toText(high) + "]", documentation);
  }
  void choice(const char* name, std::string& value, const std::vector<std::string>& allowed,
              const char* documentation) {
    std::string bounds;
    for (const auto& word : allowed) bounds += (bounds.empty() ? "" : "|") + word;
    add(name, value, bounds, documentation);
  }
  void flag(const char* name, bool& value, const char* documentation) {
    add(name, value ? "true" : "false", "true|false", documentation);
  }
  void text(const char* name, std::string& value, const char* documentation) { add(name, value, "", documentation); }

 private:
  void add(const char* name, std::string value, std::string bounds, const char* documentation) {
    entries.push_back({keyOf(name), std::move(value), std::move(bounds), documentation});
  }
};

/// Sets the one field whose key matches, from text; range and type are checked.
class Setter : public GroupVisitor<Setter> {
 public:
  Setter(std::string key, std::string value) : key_(std::move(key)), value_(std::move(value)) {}
  bool found = false;

  void field(const char* name, int& value, int low, int high, const char*) {
    if (!matches(name)) return;
    const int parsed = parseInt(key_, value_);
    checkRange(key_, parsed, low, high);
    value = parsed;
  }
  void field(const char* name, double& value, double low, double high, const char*) {
    if (!matches(name)) return;
    const double parsed = parseDouble(key_, value_);
    checkRange(key_, parsed, low, high);
    value = parsed;
  }
  void choice(const char* name, std::string& value, const std::vector<std::string>& allowed, const char*) {
    if (!matches(name)) return;
    checkChoice(key_, value_, allowed);
    value = value_;
  }
  void flag(const char* name, bool& value, const char*) {
    if (matches(name)) value = parseBool(key_, value_);
  }
  void text(const char* name, std::string& value, const char*) {
    if (matches(name)) value = value_;
  }

 private:
  bool matches(const char* name) {
    const bool match = keyOf(name) == key_;
    found = found || match;
    return match;
  }
  std::string key_, value_;
};

/// Checks every field against its bounds.
class Validator : public GroupVisitor<Validator> {
 public:
  void field(const char* name, int& value, int low, int high, const char*) {
    checkRange(keyOf(name), value, low, high);
  }
  void field(const char* name, double& value, double low, double high, const char*) {
    checkRange(keyOf(name), value, low, high);
  }
  void choice(const char* name, std::string& value, const std::vector<std::string>& allowed, const char*) {
    checkChoice(keyOf(name), value, allowed);
  }
  void flag(const char*, bool&, const char*) {}
  void text(const char*, std::string&, const char*) {}
};

}  // namespace config_detail

/// @return every key of a config with value, bounds and documentation, in the order of its description.
template <class Config>
std::vector<ConfigEntry> listConfig(Config config) {
  config_detail::Lister lister;
  config.visit(lister);
  return lister.entries;
}

/// @return the entries as a table for people to read: key, value, bounds, documentation; a line for each.
std::string describe(const std::vector<ConfigEntry>& entries);

/// Sets one key from text. @throws ConfigError naming key, bound and value if it is unknown, mistyped or out of range.
template <class Config>
void setConfig(Config& config, const std::string& key, const std::string& value);

/// @throws ConfigError naming the first key that is out of its range.
template <class Config>
void validateConfig(const Config& config) {
  config_detail::Validator validator;
  Config copy = config;
  copy.visit(validator);
}

/// Flattens a YAML file of nested maps to (dotted key, scalar as text).
/// @throws FileError if the file is missing or no YAML map of scalars.
std::vector<std::pair<std::string, std::string>> readConfigFile(const std::string& path);

namespace config_detail {
[[noreturn]] void throwUnknownKey(const std::string& key, const std::vector<ConfigEntry>& known);
}

template <class Config>
void setConfig(Config& config, const std::string& key, const std::string& value) {
  config_detail::Setter setter(key, value);
  config.visit(setter);
  if (!setter.found) config_detail::throwUnknownKey(key, listConfig(config));
}

/// Reads a YAML file over the values that config already has. @throws FileError, ConfigError.
template <class Config>
void loadConfigFile(Config& config, const std::string& path) {
  for (const auto& [key, value] : readConfigFile(path)) setConfig(config, key, value);
}

}  // namespace semantic_vslam
