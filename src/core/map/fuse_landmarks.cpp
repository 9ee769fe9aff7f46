// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/map/fuse_landmarks.h"

#include "core/features/matcher.h"
#include "core/map/visibility.h"

namespace semantic_vslam {

int fuseInto(Map& map, const std::vector<LandmarkId>& landmarks, KeyframeId keyframe_id, double virtual_baseline_m,
             double radius_px) {
  constexpr double kMinViewCosine = 0.5;
  const Keyframe* keyframe = map.keyframe(keyframe_id);
  if (!keyframe) return 0;
  std::vector<GuidedQuery> queries;
  std::vector<LandmarkId> landmark_of_query;
  for (const LandmarkId id : landmarks) {
    const Landmark* landmark = map.landmark(id);
    if (!landmark || landmark->observations.count(keyframe_id) > 0) continue;
    Sighting sighting;
    if (!predictSighting(*landmark, *keyframe->camera, keyframe->T_camera_world, kMinViewCosine, sighting)) continue;
    queries.push_back(makeGuidedQuery(*landmark, sighting, radius_px));
    landmark_of_query.push_back(id);
  }
  GuidedSearchConfig search;
  search.max_distance = kMaxDistanceStrict;
  search.virtual_bf_px_m = static_cast<float>(keyframe->camera->fx() * virtual_baseline_m);
  const FeatureGrid grid(*keyframe->features, keyframe->camera->width(), keyframe->camera->height());
  const auto matches = searchGuided(queries, *keyframe->features, grid, {}, search);

  for (const auto& match : matches) {
    const LandmarkId found = landmark_of_query[match.query];
    const LandmarkId present = map.keyframe(keyframe_id)->landmarks[match.feature];
    if (!present.valid()) {
      map.addObservation(keyframe_id, match.feature, found);
      map.refreshLandmark(found);
    } else if (map.landmark(found) && map.landmark(present)) {
      const bool found_stays = map.landmark(found)->observations.size() > map.landmark(present)->observations.size();
      map.fuseLandmarks(found_stays ? present : found, found_stays ? found : present);
    }
  }
  return static_cast<int>(matches.size());
}

}  // namespace semantic_vslam
