// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "core/features/place_index.h"
#include "core/map/map.h"
#include "core/map/tracked_frame.h"
#include "core/optimization/pose_ransac.h"
#include "core/tracking/frame_tracker.h"

namespace semantic_vslam {

struct RelocalizerConfig {
  int max_candidates = 5;
  int neighbours = 10;
  double match_ratio = 0.8;
  double wide_radius_px = 10.0;
  double narrow_radius_px = 4.0;
  int min_inliers = 40;
  int min_cells = 10;
  double max_sigma_m = 0.02;
  double ambiguity_share = 0.7;
  double ambiguity_m = 0.3;
  PoseRansacConfig ransac;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("max_candidates", max_candidates, 1, 50, "keyframes of similar appearance that are tried");
    v.field("neighbours", neighbours, 0, 50,
            "covisible keyframes of a candidate whose landmarks are looked for as well");
    v.field("match_ratio", match_ratio, 0.5, 1.0, "Lowe's test for matches by descriptor alone");
    v.field("wide_radius_px", wide_radius_px, 1.0, 100.0, "first guided search, px at full size");
    v.field("narrow_radius_px", narrow_radius_px, 1.0, 100.0, "second guided search, with the better pose");
    v.field("min_inliers", min_inliers, 10, 1000, "landmarks that must fit in the end");
    v.field("min_cells", min_cells, 1, 48,
            "of the image's 8 x 6 cells that must hold one of them: a poster is no room");
    v.field("max_sigma_m", max_sigma_m, 0.001, 1.0, "standard deviation of the camera's position, each axis");
    v.field("ambiguity_share", ambiguity_share, 0.0, 1.0,
            "refused if another pose reaches this share of the best one's landmarks: rooms that look alike");
    v.field("ambiguity_m", ambiguity_m, 0.01, 100.0, "two poses are different ones when they are this far apart");
    v.group("ransac", ransac);
  }
};

struct RelocalisationResult {
  SE3 T_camera_world = SE3::Identity();
  Matrix6d covariance = Matrix6d::Identity();  ///< of the left perturbation (m, rad)
  KeyframeId keyframe;                         ///< that the frame was recognised by
  int inliers = 0;
  std::vector<LandmarkId> landmarks;  ///< per feature of the frame; invalid id = none
};

/// Pose of a frame from the landmarks of a keyframe that it may show, without a start: descriptor matches, RANSAC on
/// P3P, then two guided searches for the landmarks of the whole group with the optimised pose in between. Accepted with
/// enough landmarks, spread over the image, and a sure position only.
/// @param group  keyframes whose landmarks count; the first one is matched by descriptors
std::optional<RelocalisationResult> localizeAt(const Map& map, const std::vector<KeyframeId>& group,
                                               const TrackedFrame& frame, const FrameTrackerConfig& tracker,
                                               const RelocalizerConfig& config);

/// Finds the camera anywhere in the map (Mur-Artal and Tardos 2015, section V.C): the keyframes most like the frame are
/// tried in turn. Nothing is returned rather than a pose of which there are two.
/// @param frame  features, grid and camera are used
/// @param among  keyframes that count; empty = all
std::optional<RelocalisationResult> relocalise(const Map& map, const PlaceIndex& index, const TrackedFrame& frame,
                                               const FrameTrackerConfig& tracker, const RelocalizerConfig& config,
                                               const std::function<bool(KeyframeId)>& among = {});

/// A keyframe with those it shares most landmarks with, itself first. Empty if it is gone.
std::vector<KeyframeId> keyframeGroup(const Map& map, KeyframeId id, int neighbours);

/// All landmarks that some keyframes see, each once, in ascending order.
std::vector<LandmarkId> landmarksSeenBy(const Map& map, const std::vector<KeyframeId>& keyframes);

}  // namespace semantic_vslam
