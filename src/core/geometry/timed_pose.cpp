// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "semantic_vslam/core/geometry/timed_pose.h"

#include <algorithm>
#include <iterator>

namespace semantic_vslam {

const TimedPose* closestPose(const std::vector<TimedPose>& poses, Stamp stamp, double max_gap_s) {
  if (poses.empty()) return nullptr;
  auto closest = std::lower_bound(poses.begin(), poses.end(), stamp,
                                  [](const TimedPose& pose, Stamp value) { return pose.stamp < value; });
  const bool earlier = closest == poses.end() || (closest != poses.begin() && stamp.ns - std::prev(closest)->stamp.ns <=
                                                                                  closest->stamp.ns - stamp.ns);
  if (earlier) --closest;
  return std::abs(secondsBetween(stamp, closest->stamp)) <= max_gap_s ? &*closest : nullptr;
}

}  // namespace semantic_vslam
