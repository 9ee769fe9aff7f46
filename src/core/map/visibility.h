// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>
#include <vector>

#include "core/features/matcher.h"
#include "core/map/map.h"
#include "core/map/tracked_frame.h"
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

/// How landmarks are looked for in a frame.
struct LandmarkSearch {
  double radius_px = 3.0;          ///< round a landmark's predicted place, at full size; grows with its octave
  double oblique_radius_px = 3.0;  ///< the same for one seen more than 3.6 degrees off its usual direction
  double min_view_cosine = 0.5;    ///< of predictSighting()
  GuidedSearchConfig matching;
};

struct LandmarkSightings {
  std::vector<LandmarkId> visible;                ///< those that the frame should show, in the order asked for
  std::vector<std::pair<LandmarkId, int>> found;  ///< those that it does, each with the index of its feature
};

/// Projects landmarks into a frame, at its present pose, and looks for them round the places where they should be.
/// Features that have a landmark already are left alone, and ids that are gone passed over.
LandmarkSightings findLandmarks(const Map& map, const std::vector<LandmarkId>& landmarks, const TrackedFrame& frame,
                                const LandmarkSearch& search);

/// A keyframe as a frame in which landmarks are looked for: none of its features has one.
TrackedFrame frameOf(const Keyframe& keyframe);

/// All landmarks that some keyframes see, each once, in ascending order.
std::vector<LandmarkId> landmarksSeenBy(const Map& map, const std::vector<KeyframeId>& keyframes);

}  // namespace semantic_vslam
