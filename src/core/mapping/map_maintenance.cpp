// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/mapping/map_maintenance.h"

#include <algorithm>
#include <iterator>
#include <map>

#include "core/map/fuse_landmarks.h"
#include "core/map/visibility.h"

namespace semantic_vslam {
namespace {

// A point that three keyframes see is confirmed (Mur-Artal and Tardos 2015, section VI.B).
constexpr int kConfirmedObservations = 3;

/// Static features with depth and without landmark, nearest first.
std::vector<int> newPoints(const Keyframe& keyframe) {
  std::vector<int> indices;
  const auto& features = keyframe.features->features;
  for (int i = 0; i < static_cast<int>(features.size()); ++i) {
    const bool usable = features[i].depth_m > 0.0F && features[i].surelyStatic();
    if (usable && !keyframe.landmarks[i].valid()) indices.push_back(i);
  }
  std::stable_sort(indices.begin(), indices.end(),
                   [&](int a, int b) { return features[a].depth_m < features[b].depth_m; });
  return indices;
}

/// Keyframes other than `except` that see the landmark at `octave` + 1 or finer.
int countFineObservers(const Map& map, const Landmark& landmark, KeyframeId except, int octave) {
  int count = 0;
  for (const auto& [id, index] : landmark.observations) {
    if (id != except && map.keyframe(id)->features->features[index].octave <= octave + 1) ++count;
  }
  return count;
}

bool isRedundant(const Map& map, const Keyframe& keyframe, double close_m, double share) {
  int close = 0, redundant = 0;
  for (std::size_t i = 0; i < keyframe.landmarks.size(); ++i) {
    const Landmark* landmark = keyframe.landmarks[i].valid() ? map.landmark(keyframe.landmarks[i]) : nullptr;
    const Feature& feature = keyframe.features->features[i];
    if (!landmark || feature.depth_m <= 0.0F || feature.depth_m > close_m) continue;
    ++close;
    if (static_cast<int>(landmark->observations.size()) <= kConfirmedObservations) continue;
    if (countFineObservers(map, *landmark, keyframe.id, feature.octave) >= kConfirmedObservations) ++redundant;
  }
  return redundant > share * close;
}

}  // namespace

KeyframeId insertKeyframe(Map& map, const TrackedFrame& frame, const SensorConfig& sensor,
                          const MapMaintenanceConfig& config) {
  Keyframe keyframe;
  keyframe.stamp = frame.stamp;
  keyframe.T_camera_world = frame.T_camera_world;
  keyframe.camera = frame.camera;
  keyframe.features = frame.features;
  keyframe.landmarks = frame.landmarks;
  const KeyframeId id = map.addKeyframe(std::move(keyframe));

  const SE3 T_world_camera = frame.T_camera_world.inverse();
  int made = 0;
  for (const int i : newPoints(*map.keyframe(id))) {
    if (frame.feature(i).depth_m > sensor.closeM() && made >= config.min_new_points) break;
    map.addLandmark(T_world_camera * frame.pointInCamera(i), id, i);
    ++made;
  }
  for (const LandmarkId landmark : frame.landmarks) {
    if (landmark.valid()) map.refreshLandmark(landmark);
  }
  return id;
}

int cullRecentLandmarks(Map& map, KeyframeId newest, const MapMaintenanceConfig& config) {
  const KeyframeId tree = map.rootOf(newest);
  std::map<KeyframeId, KeyframeId> tree_of;
  const std::size_t held = map.landmarks().size();
  std::size_t passed = 0, dropped = 0;
  // From the newest down to the first that is not recent, or to the last there is: ids grow with time. Tracking waits
  // meanwhile, so the map's size must not count.
  for (std::uint64_t id = map.nextLandmark(); passed < held && id > 0;) {
    const Landmark* landmark = map.landmark(LandmarkId(--id));
    if (!landmark) continue;
    ++passed;
    if (newest < landmark->created_in) continue;
    const std::uint64_t age = newest.value() - landmark->created_in.value();
    if (age > static_cast<std::uint64_t>(config.probation_keyframes)) break;
    const bool rarely_found = landmark->found_count < config.min_found_share * landmark->visible_count;
    // Its depth confirms a point once, so a second keyframe is enough.
    const bool unconfirmed =
        age + 1 >= static_cast<std::uint64_t>(config.probation_keyframes) && landmark->observations.size() < 2;
    if (!rarely_found && !unconfirmed) continue;
    // Keyframes of a map begun elsewhere had no chance to see it.
    const auto [its, is_new] = tree_of.try_emplace(landmark->reference_keyframe);
    if (is_new) its->second = map.rootOf(its->first);
    if (its->second != tree) continue;
    map.removeLandmark(landmark->id);
    ++dropped;
  }
  return static_cast<int>(dropped);
}

int fuseWithNeighbours(Map& map, KeyframeId keyframe_id, double virtual_baseline_m,
                       const MapMaintenanceConfig& config) {
  auto neighbours = map.covisible(keyframe_id, 1);
  if (static_cast<int>(neighbours.size()) > config.fuse_neighbours) neighbours.resize(config.fuse_neighbours);
  int fused = 0;
  std::vector<LandmarkId> theirs;
  for (const auto& [neighbour, shared] : neighbours) {
    fused += fuseInto(map, landmarksSeenBy(map, {keyframe_id}), neighbour, virtual_baseline_m, config.fuse_radius_px);
    const auto ids = landmarksSeenBy(map, {neighbour});
    theirs.insert(theirs.end(), ids.begin(), ids.end());
  }
  std::sort(theirs.begin(), theirs.end());
  theirs.erase(std::unique(theirs.begin(), theirs.end()), theirs.end());
  return fused + fuseInto(map, theirs, keyframe_id, virtual_baseline_m, config.fuse_radius_px);
}

int cullRedundantKeyframes(Map& map, KeyframeId centre, KeyframeId keep, const SensorConfig& sensor,
                           const MapMaintenanceConfig& config,
                           const std::function<void(const Keyframe&)>& before_removal) {
  int removed = 0;
  for (const auto& [id, shared] : map.covisible(centre, 1)) {
    const Keyframe& keyframe = *map.keyframe(id);
    if (id == centre || id == keep || !keyframe.parent.valid()) continue;
    if (!isRedundant(map, keyframe, sensor.closeM(), config.redundant_share)) continue;
    before_removal(keyframe);
    map.removeKeyframe(id);
    ++removed;
  }
  return removed;
}

}  // namespace semantic_vslam
