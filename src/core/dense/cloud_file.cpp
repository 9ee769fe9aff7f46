// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/dense/cloud_file.h"

#include <cstring>

#include "core/common/atomic_file.h"

namespace semantic_vslam {

void appendLittleEndian(std::string& out, std::uint32_t value) {
  for (int byte = 0; byte < 4; ++byte) out.push_back(static_cast<char>(value >> (8 * byte) & 0xFF));
}

void appendFloat(std::string& out, float value) {
  std::uint32_t bits = 0;
  static_assert(sizeof(bits) == sizeof(value), "PCD fields are IEEE 754 single precision");
  std::memcpy(&bits, &value, sizeof(bits));
  appendLittleEndian(out, bits);
}

std::string labelComments(const LabelSet& labels, const std::string& comment) {
  std::string lines;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    lines += comment + " label " + std::to_string(i) + " " + labels.classes[i].name + "\n";
  }
  return lines;
}

namespace {

std::string pcdHeader(std::size_t points, const LabelSet& labels) {
  const std::string count = std::to_string(points);
  return "# .PCD v0.7 - Point Cloud Data file format\n" + labelComments(labels, "#") +
         "VERSION 0.7\n"
         "FIELDS x y z rgb label\n"
         "SIZE 4 4 4 4 4\n"
         "TYPE F F F F U\n"
         "COUNT 1 1 1 1 1\n"
         "WIDTH " +
         count + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + count + "\nDATA binary\n";
}

}  // namespace

void writePcd(const std::vector<LabelledPoint>& points, const LabelSet& labels, const std::string& path) {
  constexpr std::size_t kPointBytes = 20;
  std::string content = pcdHeader(points.size(), labels);
  content.reserve(content.size() + kPointBytes * points.size());
  for (const LabelledPoint& point : points) {
    for (int axis = 0; axis < 3; ++axis) appendFloat(content, point.xyz_m[axis]);
    appendLittleEndian(content, static_cast<std::uint32_t>(point.bgr[2]) << 16 |
                                    static_cast<std::uint32_t>(point.bgr[1]) << 8 | point.bgr[0]);
    appendLittleEndian(content, point.label);
  }
  writeTextAtomically(path, content);
}

}  // namespace semantic_vslam
