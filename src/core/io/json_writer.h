// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace semantic_vslam {

/// Writes one JSON object of numbers, words, their arrays and nested objects, in the order of the calls.
class JsonWriter {
 public:
  JsonWriter() { text_ = "{"; }

  /// Nine significant digits; null if the value is not finite.
  void field(const std::string& name, double value);
  void field(const std::string& name, std::uint64_t value);
  void field(const std::string& name, int value);
  void field(const std::string& name, bool value);
  void field(const std::string& name, const std::string& value);
  void field(const std::string& name, const char* value) { field(name, std::string(value)); }
  /// Arrays stand on one line.
  void field(const std::string& name, const std::vector<double>& values);
  void field(const std::string& name, const std::vector<std::string>& values);
  void null(const std::string& name);
  void beginObject(const std::string& name);
  void endObject();
  /// Closes the outer object. @return the whole text, ending in a line break.
  std::string finish();

 private:
  void key(const std::string& name);
  std::string text_;
  int depth_ = 1;
  bool first_ = true;
};

}  // namespace semantic_vslam
