// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/io/json_writer.h"

#include <cassert>
#include <cmath>
#include <cstdio>

namespace semantic_vslam {
namespace {

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      char escape[8];
      std::snprintf(escape, sizeof escape, "\\u%04x", c);
      out += escape;
    } else {
      out += c;
    }
  }
  return out + "\"";
}

std::string number(double value) {
  if (!std::isfinite(value)) return "null";
  char text[40];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

template <class Value, class Format>
std::string array(const std::vector<Value>& values, Format format) {
  std::string text = "[";
  for (const Value& value : values) text += (text.size() > 1 ? ", " : "") + format(value);
  return text + "]";
}

}  // namespace

void JsonWriter::key(const std::string& name) {
  text_ += first_ ? "\n" : ",\n";
  text_ += std::string(static_cast<std::size_t>(2 * depth_), ' ') + quoted(name) + ": ";
  first_ = false;
}

void JsonWriter::field(const std::string& name, double value) {
  key(name);
  text_ += number(value);
}

void JsonWriter::field(const std::string& name, std::uint64_t value) {
  key(name);
  text_ += std::to_string(value);
}

void JsonWriter::field(const std::string& name, int value) {
  key(name);
  text_ += std::to_string(value);
}

void JsonWriter::field(const std::string& name, bool value) {
  key(name);
  text_ += value ? "true" : "false";
}

void JsonWriter::field(const std::string& name, const std::string& value) {
  key(name);
  text_ += quoted(value);
}

void JsonWriter::field(const std::string& name, const std::vector<double>& values) {
  key(name);
  text_ += array(values, number);
}

void JsonWriter::field(const std::string& name, const std::vector<std::string>& values) {
  key(name);
  text_ += array(values, quoted);
}

void JsonWriter::null(const std::string& name) {
  key(name);
  text_ += "null";
}

void JsonWriter::beginObject(const std::string& name) {
  key(name);
  text_ += "{";
  ++depth_;
  first_ = true;
}

void JsonWriter::endObject() {
  assert(depth_ > 1);
  --depth_;
  if (!first_) text_ += "\n" + std::string(static_cast<std::size_t>(2 * depth_), ' ');
  text_ += "}";
  first_ = false;
}

std::string JsonWriter::finish() {
  assert(depth_ == 1);
  return text_ + "\n}\n";
}

}  // namespace semantic_vslam
