// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/features/matcher.h"
#include "core/map/map.h"
#include "semantic_vslam/core/camera/camera_model.h"
#include "semantic_vslam/core/geometry/se3.h"

namespace semantic_vslam {

/// How a landmark would appear to a camera.
struct Sighting {
  Eigen::Vector2d undistorted_px;
  double depth_m = 0.0;
  double view_cosine = 1.0;  ///< between this view and the landmark's mean view direction
  int octave = 0;            ///< pyramid level at which it looks as it did when it was first seen
};

/// Predicts a sighting: in front of the camera, inside the image, within the distance range of the pyramid (one level
/// of tolerance) and not seen from too far aside (Mur-Artal and Tardos 2015, section V.D).
/// @param min_view_cosine  e.g. 0.5 for 60 degrees  @return false if it cannot be seen
bool predictSighting(const Landmark& landmark, const CameraModel& camera, const SE3& T_camera_world,
                     double min_view_cosine, Sighting& sighting);

/// The guided query for a predicted sighting. @param radius_px  at full size; grows with the octave
GuidedQuery makeGuidedQuery(const Landmark& landmark, const Sighting& sighting, double radius_px);

}  // namespace semantic_vslam
