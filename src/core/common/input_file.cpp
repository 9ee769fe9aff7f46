// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/common/input_file.h"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <set>
#include <vector>

#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

namespace fs = std::filesystem;

// What people write has some kilobytes.
constexpr std::uintmax_t kMostYamlBytes = 4 << 20;

/// Goes through a YAML document before anything is built of it.
class Check final : public YAML::EventHandler {
 public:
  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t) override { value(mark, ""); }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
    throw YAML::ParserException(mark, "aliases (*name) are not taken; write the values out");
  }
  void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t, const std::string& text) override {
    value(mark, text);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {
    open(mark, false);
  }
  void OnSequenceEnd() override { levels_.pop_back(); }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {
    open(mark, true);
  }
  void OnMapEnd() override { levels_.pop_back(); }

 private:
  struct Level {
    bool is_map = false, key_is_next = true;
    std::set<std::string> keys;
  };

  void open(const YAML::Mark& mark, bool is_map) {
    constexpr std::size_t kDeepest = 50;
    if (levels_.size() == kDeepest) throw YAML::ParserException(mark, "nested too deeply");
    if (!levels_.empty() && levels_.back().is_map && levels_.back().key_is_next) {
      throw YAML::ParserException(mark, "a key must be a word");
    }
    value(mark, "");
    levels_.push_back({is_map, true, {}});
  }
  void value(const YAML::Mark& mark, const std::string& text) {
    if (levels_.empty() || !levels_.back().is_map) return;
    Level& map = levels_.back();
    if (map.key_is_next && !map.keys.insert(text).second) {
      throw YAML::ParserException(mark, "key '" + text + "' is said twice");
    }
    map.key_is_next = !map.key_is_next;
  }

  std::vector<Level> levels_;
};

}  // namespace

void requireRegularFile(const std::string& what, const std::string& path) {
  const std::string named = what + " '" + printable(path) + "'";
  if (path.find('\0') != std::string::npos) throw FileError(named + " has a zero byte in its name");
  std::error_code failed;
  const fs::file_status status = fs::status(path, failed);
  if (!fs::exists(status) || fs::is_regular_file(status)) return;
  throw FileError(named + (fs::is_directory(status) ? " is a folder" : " is no regular file") + "; name a file");
}

YAML::Node readYamlFile(const std::string& what, const std::string& path) {
  requireRegularFile(what, path);
  std::ifstream file(path);
  if (!file) throw FileError(what + " '" + path + "' cannot be opened");
  if (fs::file_size(path) > kMostYamlBytes)
    throw FileError(what + " '" + path + "' has more than 4 MB: it is no such file");
  try {
    Check check;
    YAML::Parser(file).HandleNextDocument(check);
    return YAML::LoadFile(path);
  } catch (const YAML::Exception& error) {
    throw FileError(what + " '" + path + "' is no valid YAML: " + printable(error.what()));
  }
}

std::string printable(const std::string& text) {
  std::string out;
  const auto byteAt = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U; };
  for (std::size_t i = 0; i < text.size(); ++i) {
    const unsigned byte = byteAt(i);
    // Terminals obey C2 80 to C2 9F in UTF-8, too.
    const auto isC1 = [&](std::size_t at) {
      return byteAt(at) == 0xC2 && byteAt(at + 1) >= 0x80 && byteAt(at + 1) < 0xA0;
    };
    const bool c1 = isC1(i) || (i > 0 && isC1(i - 1));
    if (byte >= 0x20 && byte != 0x7F && !c1) {
      out += text[i];
      continue;
    }
    char code[5];
    std::snprintf(code, sizeof code, "\\x%02X", byte);
    out += code;
  }
  return out;
}

}  // namespace semantic_vslam
