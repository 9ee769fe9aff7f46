// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/tracking/initializer.h"

#include <algorithm>
#include <utility>

#include "semantic_vslam/core/common/config_fields.h"

namespace semantic_vslam {

Initializer::Initializer(const InitializerConfig& config, const FrameTrackerConfig& tracker)
    : config_(config), tracker_(tracker) {
  validateConfig(config_);
  validateConfig(tracker_);
}

bool Initializer::isUsable(const TrackedFrame& frame) const {
  const auto& features = frame.features->features;
  const auto points =
      std::count_if(features.begin(), features.end(), [](const Feature& feature) { return feature.depth_m > 0.0F; });
  return points >= config_.min_points;
}

std::optional<TrackedFrame> Initializer::offer(TrackedFrame& frame) {
  if (first_) {
    // An empty map: all of k1's points with depth are looked for in k2 where k1 saw them.
    const PoseEstimate estimate = trackFromLastFrame(Map(), *first_, first_->T_camera_world, tracker_, frame);
    const bool agree =
        estimate.inliers >= config_.min_inliers && estimate.inliers >= config_.min_inlier_share * estimate.matches;
    if (estimate.success && agree) return std::exchange(first_, std::nullopt);
    first_.reset();
  }
  if (isUsable(frame)) {
    first_ = frame;
    first_->T_camera_world = SE3::Identity();
  }
  return std::nullopt;
}

}  // namespace semantic_vslam
