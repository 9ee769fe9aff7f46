// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/map/visibility.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/camera/observation_model.h"

namespace semantic_vslam {
namespace {

/// @param radius_px  at full size; grows with the octave
GuidedQuery makeGuidedQuery(const Landmark& landmark, const Sighting& sighting, double radius_px) {
  GuidedQuery query;
  query.descriptor = landmark.descriptor.ptr();
  query.predicted_px = sighting.undistorted_px.cast<float>();
  query.radius_px = static_cast<float>(radius_px * pyramidScale(sighting.octave));
  query.min_octave = sighting.octave - 1;
  query.max_octave = sighting.octave + 1;
  query.depth_m = static_cast<float>(sighting.depth_m);
  return query;
}

}  // namespace

bool predictSighting(const Landmark& landmark, const CameraModel& camera, const SE3& T_camera_world,
                     double min_view_cosine, Sighting& sighting) {
  const Eigen::Vector3d p = T_camera_world * landmark.position_world;
  if (p.z() < kMinProjectionDepthM) return false;
  sighting.undistorted_px = camera.projectUndistorted(p);
  if (!camera.contains(sighting.undistorted_px)) return false;
  const double distance_m = p.norm();
  if (distance_m > kPyramidScale * landmark.max_distance_m) return false;
  if (distance_m < landmark.min_distance_m / kPyramidScale) return false;
  sighting.view_cosine = p.dot(T_camera_world.linear() * landmark.mean_view_direction) / distance_m;
  if (sighting.view_cosine < min_view_cosine) return false;
  sighting.depth_m = p.z();
  const double level = std::log(landmark.max_distance_m / distance_m) / std::log(kPyramidScale);
  // Rounding noise must not lift a landmark seen from its reference distance to the next level.
  sighting.octave = std::clamp(static_cast<int>(std::ceil(level - 1e-6)), 0, kPyramidLevels - 1);
  return true;
}

LandmarkSightings findLandmarks(const Map& map, const std::vector<LandmarkId>& landmarks, const TrackedFrame& frame,
                                const LandmarkSearch& search) {
  constexpr double kFrontalCosine = 0.998;  // 3.6 degrees
  LandmarkSightings sightings;
  std::vector<GuidedQuery> queries;
  for (const LandmarkId id : landmarks) {
    const Landmark* landmark = map.landmark(id);
    Sighting sighting;
    if (landmark == nullptr ||
        !predictSighting(*landmark, *frame.camera, frame.T_camera_world, search.min_view_cosine, sighting)) {
      continue;
    }
    const bool frontal = sighting.view_cosine > kFrontalCosine;
    queries.push_back(makeGuidedQuery(*landmark, sighting, frontal ? search.radius_px : search.oblique_radius_px));
    sightings.visible.push_back(id);
  }
  std::vector<bool> taken(frame.landmarks.size());
  for (std::size_t i = 0; i < taken.size(); ++i) taken[i] = frame.landmarks[i].valid();
  for (const auto& match : searchGuided(queries, *frame.features, frame.grid, taken, search.matching)) {
    sightings.found.emplace_back(sightings.visible[match.query], match.feature);
  }
  return sightings;
}

TrackedFrame frameOf(const Keyframe& keyframe) {
  TrackedFrame frame;
  frame.stamp = keyframe.stamp;
  frame.camera = keyframe.camera;
  frame.features = keyframe.features;
  frame.grid = FeatureGrid(*keyframe.features, keyframe.camera->width(), keyframe.camera->height());
  frame.T_camera_world = keyframe.T_camera_world;
  return frame;
}

std::vector<LandmarkId> landmarksSeenBy(const Map& map, const std::vector<KeyframeId>& keyframes) {
  std::vector<LandmarkId> ids;
  for (const KeyframeId id : keyframes) {
    const Keyframe* keyframe = map.keyframe(id);
    if (keyframe == nullptr) continue;
    std::copy_if(keyframe->landmarks.begin(), keyframe->landmarks.end(), std::back_inserter(ids),
                 [](LandmarkId landmark) { return landmark.valid(); });
  }
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

}  // namespace semantic_vslam
