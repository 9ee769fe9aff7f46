// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "semantic_vslam/core/common/stamp.h"
#include "semantic_vslam/core/geometry/se3.h"
#include "semantic_vslam/core/geometry/timed_pose.h"

namespace semantic_vslam {

/// Reads decimal seconds (`1305031102.175304`) digit by digit, so that no nanosecond is lost to floating point; digits
/// past the ninth decimal are dropped. Scientific notation is accepted too, and whole nanoseconds, as other benchmarks
/// have them (17 digits or more). @return nothing if it is no number.
std::optional<Stamp> parseStamp(const std::string& seconds);

/// Decimal seconds with 6 to 9 decimals, as many as the stamp needs.
std::string formatStamp(Stamp stamp);

/// Reads a trajectory of the TUM RGB-D benchmark: `stamp tx ty tz qx qy qz qw` a line (s, m, unit quaternion),
/// separated by spaces, tabs or commas; `#` starts a comment. Poses that hold NaN are left out, as the benchmark's
/// tools do.
/// @return poses in order of time; of two with one stamp the later line counts.
/// @throws FileError naming file and line.
std::vector<TimedPose> readTumTrajectory(const std::string& path);

/// Writes it, whole or not at all. @throws FileError naming the file and the cause.
void writeTumTrajectory(const std::string& path, const std::vector<TimedPose>& poses);

}  // namespace semantic_vslam
