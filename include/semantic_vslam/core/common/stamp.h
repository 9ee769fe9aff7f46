// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>

namespace semantic_vslam {

/// Point in time in integer nanoseconds since the epoch, from `header.stamp` or a TUM file. Never wall time.
struct Stamp {
  std::int64_t ns = 0;

  static Stamp fromSeconds(double seconds) { return Stamp{static_cast<std::int64_t>(std::llround(seconds * 1e9))}; }
  double seconds() const { return static_cast<double>(ns) * 1e-9; }

  friend bool operator==(Stamp a, Stamp b) { return a.ns == b.ns; }
  friend bool operator!=(Stamp a, Stamp b) { return a.ns != b.ns; }
  friend bool operator<(Stamp a, Stamp b) { return a.ns < b.ns; }
  friend bool operator<=(Stamp a, Stamp b) { return a.ns <= b.ns; }
  friend bool operator>(Stamp a, Stamp b) { return a.ns > b.ns; }
};

/// @return b - a in seconds.
inline double secondsBetween(Stamp a, Stamp b) { return static_cast<double>(b.ns - a.ns) * 1e-9; }

}  // namespace semantic_vslam

namespace std {
template <>
struct hash<semantic_vslam::Stamp> {
  size_t operator()(semantic_vslam::Stamp stamp) const { return hash<int64_t>()(stamp.ns); }
};
}  // namespace std
