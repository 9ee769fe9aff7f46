// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/tracking/keyframe_policy.h"

namespace semantic_vslam {

bool keyframeIsDue(const KeyframeEvidence& e, const KeyframePolicyConfig& config) {
  constexpr int kMinimumTracked = 15;  // with fewer the pose is too weak to add anything to the map
  if (e.tracked < kMinimumTracked) return false;
  const bool starving = e.close_tracked < config.min_close_tracked && e.close_new > config.min_close_new;
  const bool fading = e.tracked < config.min_tracked && e.all_new > config.min_close_new &&
                      e.frames_since_keyframe >= config.min_gap_frames;
  const bool overdue = e.frames_since_keyframe >= config.max_gap_frames;
  const bool ready = e.frames_since_keyframe >= config.min_gap_frames && e.mapper_idle;
  const bool very_weak = e.tracked < 0.25 * e.most_tracked;
  const bool sees_new = e.tracked < config.min_view_share * e.most_tracked;
  return (overdue || ready || very_weak || starving || fading) && (sees_new || starving || fading);
}

void countClose(const TrackedFrame& frame, double close_m, KeyframeEvidence& evidence) {
  for (int i = 0; i < static_cast<int>(frame.features->size()); ++i) {
    const Feature& feature = frame.feature(i);
    if (feature.depth_m <= 0.0F || !feature.surelyStatic()) continue;
    const bool has_landmark = frame.landmarks[i].valid();
    if (!has_landmark) ++evidence.all_new;
    if (feature.depth_m <= close_m) ++(has_landmark ? evidence.close_tracked : evidence.close_new);
  }
}

}  // namespace semantic_vslam
