// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/map/visibility.h"

#include <algorithm>
#include <cmath>

#include "core/camera/observation_model.h"

namespace semantic_vslam {

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

}  // namespace semantic_vslam
