// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/map/fuse_landmarks.h"

#include <algorithm>
#include <iterator>

#include "core/features/matcher.h"
#include "core/map/visibility.h"

namespace semantic_vslam {

int fuseInto(Map& map, const std::vector<LandmarkId>& landmarks, KeyframeId keyframe_id, double virtual_baseline_m,
             double radius_px) {
  const Keyframe* keyframe = map.keyframe(keyframe_id);
  if (!keyframe) return 0;
  std::vector<LandmarkId> unseen;
  std::copy_if(landmarks.begin(), landmarks.end(), std::back_inserter(unseen), [&](LandmarkId id) {
    const Landmark* landmark = map.landmark(id);
    return landmark != nullptr && landmark->observations.count(keyframe_id) == 0;
  });
  LandmarkSearch search;
  search.radius_px = search.oblique_radius_px = radius_px;
  search.matching.max_distance = kMaxDistanceStrict;
  search.matching.virtual_bf_px_m = static_cast<float>(keyframe->camera->fx() * virtual_baseline_m);
  const auto matches = findLandmarks(map, unseen, frameOf(*keyframe), search).found;

  for (const auto& [found, feature] : matches) {
    const LandmarkId present = map.keyframe(keyframe_id)->landmarks[feature];
    if (!present.valid()) {
      map.addObservation(keyframe_id, feature, found);
      map.refreshLandmark(found);
    } else if (map.landmark(found) && map.landmark(present)) {
      const bool found_stays = map.landmark(found)->observations.size() > map.landmark(present)->observations.size();
      map.fuseLandmarks(found_stays ? present : found, found_stays ? found : present);
    }
  }
  return static_cast<int>(matches.size());
}

}  // namespace semantic_vslam
