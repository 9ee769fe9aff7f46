// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/tracking/local_map.h"

#include <algorithm>
#include <iterator>
#include <set>
#include <utility>

#include "core/features/matcher.h"
#include "core/map/visibility.h"

namespace semantic_vslam {
namespace {

/// Keyframes that see the frame's landmarks, most shared first.
std::vector<std::pair<KeyframeId, int>> voteKeyframes(const Map& map, const TrackedFrame& frame) {
  std::vector<int> votes(map.nextKeyframe(), 0);  // by id
  for (const LandmarkId id : frame.landmarks) {
    const Landmark* landmark = id.valid() ? map.landmark(id) : nullptr;
    if (!landmark) continue;
    for (const auto& [keyframe, index] : landmark->observations) {
      ++votes[keyframe.value()];
    }
  }
  std::vector<std::pair<KeyframeId, int>> sorted;
  for (std::size_t i = 0; i < votes.size(); ++i) {
    if (votes[i] > 0) sorted.emplace_back(KeyframeId(i), votes[i]);
  }
  std::stable_sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  return sorted;
}

}  // namespace

LocalMap selectLocalMap(const Map& map, const TrackedFrame& frame, const LocalMapConfig& config) {
  LocalMap local;
  const auto votes = voteKeyframes(map, frame);
  if (votes.empty()) return local;
  local.reference = votes.front().first;
  std::set<KeyframeId> chosen;
  const auto most = std::min<std::size_t>(config.max_keyframes, map.keyframes().size());
  const auto full = [&] { return chosen.size() >= most; };
  for (const auto& [id, count] : votes) {
    if (!full()) chosen.insert(id);
  }
  for (const auto& [id, count] : votes) {
    if (full()) break;
    const auto neighbours = map.covisible(id, 1);
    for (int i = 0; i < std::min<int>(config.neighbours, static_cast<int>(neighbours.size())) && !full(); ++i) {
      chosen.insert(neighbours[i].first);
    }
    const KeyframeId parent = map.keyframe(id)->parent;
    if (parent.valid() && !full()) chosen.insert(parent);
  }
  local.keyframes.assign(chosen.begin(), chosen.end());
  std::vector<bool> taken(map.nextLandmark(), false);  // ids are dense: far cheaper than to sort tens of thousands
  for (const KeyframeId id : local.keyframes) {
    for (const LandmarkId landmark : map.keyframe(id)->landmarks) {
      if (!landmark.valid() || taken[landmark.value()]) continue;
      taken[landmark.value()] = true;
      local.landmarks.push_back(landmark);
    }
  }
  std::sort(local.landmarks.begin(), local.landmarks.end());
  return local;
}

std::vector<LandmarkId> matchLocalMap(const Map& map, const LocalMap& local_map, double virtual_bf_px_m,
                                      const LocalMapConfig& config, TrackedFrame& frame) {
  std::vector<LandmarkId> visible;
  std::copy_if(frame.landmarks.begin(), frame.landmarks.end(), std::back_inserter(visible),
               [](LandmarkId id) { return id.valid(); });
  std::sort(visible.begin(), visible.end());
  std::vector<LandmarkId> missing;
  std::set_difference(local_map.landmarks.begin(), local_map.landmarks.end(), visible.begin(), visible.end(),
                      std::back_inserter(missing));

  LandmarkSearch search;
  search.radius_px = config.search_radius_px;
  search.oblique_radius_px = config.wide_radius_px;
  search.min_view_cosine = config.min_view_cosine;
  search.matching.ratio = 0.8F;  // neighbouring landmarks look alike at this small radius
  search.matching.virtual_bf_px_m = static_cast<float>(virtual_bf_px_m);
  const LandmarkSightings sightings = findLandmarks(map, missing, frame, search);
  for (const auto& [id, feature] : sightings.found) frame.landmarks[feature] = id;
  visible.insert(visible.end(), sightings.visible.begin(), sightings.visible.end());
  return visible;
}

}  // namespace semantic_vslam
