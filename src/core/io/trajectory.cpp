// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/io/trajectory.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <sstream>

#include "core/common/atomic_file.h"
#include "core/common/input_file.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

constexpr std::int64_t kNsPerSecond = 1000000000;

std::optional<Stamp> parseScientific(const std::string& text) {
  char* end = nullptr;
  const long double seconds = std::strtold(text.c_str(), &end);
  constexpr long double kMostSeconds = 9.2e9;  // what 64 bits of nanoseconds hold
  if (end != text.c_str() + text.size() || !(std::abs(seconds) <= kMostSeconds)) return std::nullopt;
  return Stamp{static_cast<std::int64_t>(std::llround(seconds * kNsPerSecond))};
}

/// @return the eight numbers of a line; nothing if it has another form.
std::optional<TimedPose> parsePose(std::string line) {
  std::replace(line.begin(), line.end(), ',', ' ');
  std::istringstream in(line);
  std::string stamp_text;
  in >> stamp_text;
  const std::optional<Stamp> stamp = parseStamp(stamp_text);
  std::array<double, 7> values{};
  for (double& value : values) {
    std::string text;
    in >> text;
    char* end = nullptr;
    value = std::strtod(text.c_str(), &end);  // unlike operator>>, reads "nan"
    if (text.empty() || *end != '\0') return std::nullopt;
  }
  if (!stamp) return std::nullopt;
  const auto& [x, y, z, qx, qy, qz, qw] = values;
  // NaN, by which some tools mark what they do not know, passes.
  constexpr double kFarthestM = 1e9, kLeastNorm = 1e-3;
  if (std::abs(x) > kFarthestM || std::abs(y) > kFarthestM || std::abs(z) > kFarthestM) return std::nullopt;
  if (Eigen::Vector4d(qx, qy, qz, qw).norm() < kLeastNorm) return std::nullopt;
  TimedPose pose;
  pose.stamp = *stamp;
  pose.T_world_camera = makeSE3(Eigen::Quaterniond(qw, qx, qy, qz), {x, y, z});
  return pose;
}

bool isBlankOrComment(const std::string& line) {
  const std::size_t first = line.find_first_not_of(" \t\r");
  return first == std::string::npos || line[first] == '#';
}

void sortAndDropDuplicates(std::vector<TimedPose>& poses) {
  std::stable_sort(poses.begin(), poses.end(),
                   [](const TimedPose& a, const TimedPose& b) { return a.stamp < b.stamp; });
  std::vector<TimedPose> unique;
  for (const TimedPose& pose : poses) {
    if (!unique.empty() && unique.back().stamp == pose.stamp) unique.pop_back();
    unique.push_back(pose);
  }
  poses = std::move(unique);
}

}  // namespace

std::optional<Stamp> parseStamp(const std::string& seconds) {
  if (seconds.find_first_of("eE") != std::string::npos) return parseScientific(seconds);
  std::size_t i = 0;
  const bool negative = !seconds.empty() && seconds[0] == '-';
  if (negative) ++i;
  std::int64_t ns = 0;
  int digits = 0, decimals = -1;  // decimals is -1 until the point
  for (; i < seconds.size(); ++i) {
    if (seconds[i] == '.' && decimals < 0) {
      decimals = 0;
    } else if (std::isdigit(static_cast<unsigned char>(seconds[i])) != 0) {
      ++digits;
      if (decimals == 9) continue;
      if (decimals >= 0) ++decimals;
      if (ns > (INT64_MAX - 9) / 10) return std::nullopt;
      ns = ns * 10 + (seconds[i] - '0');
    } else {
      return std::nullopt;
    }
  }
  if (digits == 0) return std::nullopt;
  constexpr int kNanosecondDigits = 17;  // fewer have been since 1973
  if (decimals < 0 && digits >= kNanosecondDigits) return Stamp{negative ? -ns : ns};
  for (int have = std::max(decimals, 0); have < 9; ++have) {
    if (ns > INT64_MAX / 10) return std::nullopt;
    ns *= 10;
  }
  return Stamp{negative ? -ns : ns};
}

std::string formatStamp(Stamp stamp) {
  const std::int64_t magnitude = std::abs(stamp.ns);
  char text[40];
  std::snprintf(text, sizeof text, "%s%lld.%09lld", stamp.ns < 0 ? "-" : "",
                static_cast<long long>(magnitude / kNsPerSecond), static_cast<long long>(magnitude % kNsPerSecond));
  std::string out = text;
  for (int decimals = 9; decimals > 6 && out.back() == '0'; --decimals) out.pop_back();
  return out;
}

std::vector<TimedPose> readTumTrajectory(const std::string& path) {
  requireRegularFile("trajectory file", path);
  std::ifstream in(path);
  if (!in) throw FileError("trajectory file '" + path + "' cannot be opened");
  std::vector<TimedPose> poses;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (isBlankOrComment(line)) continue;
    const std::optional<TimedPose> pose = parsePose(line);
    if (!pose) {
      throw FileError("trajectory file '" + path + "', line " + std::to_string(number) +
                      ": expected 'stamp tx ty tz qx qy qz qw' (s, m up to 1e9, unit quaternion)");
    }
    if (pose->T_world_camera.matrix().allFinite()) poses.push_back(*pose);
  }
  if (in.bad()) throw FileError("trajectory file '" + path + "' cannot be read");
  sortAndDropDuplicates(poses);
  return poses;
}

void writeTumTrajectory(const std::string& path, const std::vector<TimedPose>& poses) {
  std::string content = "# timestamp tx ty tz qx qy qz qw\n";
  for (const TimedPose& pose : poses) {
    const Eigen::Vector3d t = pose.T_world_camera.translation();
    Eigen::Quaterniond q(pose.T_world_camera.linear());
    if (q.w() < 0.0) q.coeffs() = -q.coeffs();  // q and -q are one rotation; write one of them
    char line[256];
    std::snprintf(line, sizeof line, "%s %.7f %.7f %.7f %.9f %.9f %.9f %.9f\n", formatStamp(pose.stamp).c_str(), t.x(),
                  t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
    content += line;
  }
  writeTextAtomically(path, content);
}

}  // namespace semantic_vslam
