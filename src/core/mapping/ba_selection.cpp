// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/mapping/ba_selection.h"

#include <algorithm>
#include <map>
#include <utility>

#include "core/map/visibility.h"

namespace semantic_vslam {
namespace {

/// Copies keyframes and landmarks of a map into a problem, each once.
class ProblemBuilder {
 public:
  ProblemBuilder(const Map& map, const SensorConfig& sensor) : map_(map) {
    problem_.map_version = map.version();
    problem_.sensor = sensor;
  }

  void addKeyframe(KeyframeId id, bool fixed) {
    const Keyframe& keyframe = *map_.keyframe(id);
    keyframe_index_[id] = static_cast<int>(problem_.keyframes.size());
    problem_.keyframes.push_back({id, keyframe.T_camera_world, keyframe.camera->intrinsics(), fixed});
  }

  /// Adds a landmark with its sightings by those keyframes that are there.
  void addLandmark(const Landmark& landmark) {
    const int index = static_cast<int>(problem_.landmarks.size());
    problem_.landmarks.push_back({landmark.id, landmark.position_world});
    for (const auto& [keyframe_id, feature_index] : landmark.observations) {
      const auto keyframe = keyframe_index_.find(keyframe_id);
      if (keyframe == keyframe_index_.end()) continue;
      const Feature& feature = map_.keyframe(keyframe_id)->features->features[feature_index];
      problem_.observations.push_back({keyframe->second, index, feature.undistorted_px.cast<double>(), feature.depth_m,
                                       pyramidScale(feature.octave), feature.static_weight});
    }
  }

  BaProblem take() { return std::move(problem_); }

 private:
  const Map& map_;
  BaProblem problem_;
  std::map<KeyframeId, int> keyframe_index_;
};

std::vector<KeyframeId> adjustedKeyframes(const Map& map, KeyframeId centre, const BaConfig& config) {
  std::vector<KeyframeId> chosen = {centre};
  for (const auto& [neighbour, shared] : map.covisible(centre, config.min_shared)) {
    if (static_cast<int>(chosen.size()) >= config.max_keyframes) break;
    chosen.push_back(neighbour);
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

/// Keyframes outside `inside` that see the landmarks, those that see most first.
std::vector<KeyframeId> ring(const Map& map, const std::vector<LandmarkId>& landmarks,
                             const std::vector<KeyframeId>& inside, int max_keyframes) {
  std::map<KeyframeId, int> counts;
  for (const LandmarkId id : landmarks) {
    for (const auto& [keyframe, feature_index] : map.landmark(id)->observations) {
      if (!std::binary_search(inside.begin(), inside.end(), keyframe)) ++counts[keyframe];
    }
  }
  std::vector<std::pair<KeyframeId, int>> ordered(counts.begin(), counts.end());
  std::stable_sort(ordered.begin(), ordered.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  std::vector<KeyframeId> chosen;
  for (const auto& [keyframe, count] : ordered) {
    if (static_cast<int>(chosen.size()) >= max_keyframes) break;
    chosen.push_back(keyframe);
  }
  return chosen;
}

}  // namespace

BaProblem selectLocal(const Map& map, KeyframeId centre, const SensorConfig& sensor, const BaConfig& config) {
  ProblemBuilder builder(map, sensor);
  if (map.keyframe(centre) == nullptr) return builder.take();
  const std::vector<KeyframeId> adjusted = adjustedKeyframes(map, centre, config);
  const std::vector<LandmarkId> landmarks = landmarksSeenBy(map, adjusted);
  const std::vector<KeyframeId> around = ring(map, landmarks, adjusted, config.max_fixed_keyframes);

  // Somebody must hold the frame of reference: the map's first keyframe, the ring, or else the oldest.
  const KeyframeId first = map.keyframes().begin()->first;
  const KeyframeId holder = around.empty() ? adjusted.front() : first;
  for (const KeyframeId id : adjusted) builder.addKeyframe(id, id == first || id == holder);
  for (const KeyframeId id : around) builder.addKeyframe(id, true);
  for (const LandmarkId id : landmarks) builder.addLandmark(*map.landmark(id));
  return builder.take();
}

BaProblem selectGlobal(const Map& map, const SensorConfig& sensor) {
  ProblemBuilder builder(map, sensor);
  for (const auto& [id, keyframe] : map.keyframes()) builder.addKeyframe(id, !keyframe.parent.valid());
  std::vector<LandmarkId> ids;
  for (const auto& [id, landmark] : map.landmarks()) ids.push_back(id);
  std::sort(ids.begin(), ids.end());
  for (const LandmarkId id : ids) builder.addLandmark(*map.landmark(id));
  return builder.take();
}

}  // namespace semantic_vslam
