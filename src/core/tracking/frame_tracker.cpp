// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/tracking/frame_tracker.h"

#include "core/features/matcher.h"

namespace semantic_vslam {
namespace {

/// A point of the last frame to be found again.
struct Source {
  LandmarkId landmark;  ///< invalid: a point with depth that is no landmark
  Eigen::Vector3d point_world;
  double trust = kLeastTrust;
  int feature = 0;  ///< index in the last frame
};

std::vector<Source> collectSources(const Map& map, const TrackedFrame& last) {
  std::vector<Source> sources;
  const SE3 T_world_last = last.T_camera_world.inverse();
  for (int i = 0; i < static_cast<int>(last.features->size()); ++i) {
    if (const Landmark* landmark = map.landmark(last.landmarks[i])) {
      sources.push_back({landmark->id, landmark->position_world, trustOf(*landmark), i});
    } else if (last.feature(i).depth_m > 0.0F) {
      sources.push_back({LandmarkId(), T_world_last * last.pointInCamera(i), kLeastTrust, i});
    }
  }
  return sources;
}

/// Pyramid levels in which a point may reappear: closer than before means coarser, farther means finer.
void setOctaveRange(double depth_before_m, double depth_now_m, int octave, GuidedQuery& query) {
  const double ratio = depth_before_m / depth_now_m;
  query.min_octave = ratio > 1.0 / kPyramidScale ? octave - 1 : octave - 2;
  query.max_octave = ratio < kPyramidScale ? octave + 1 : octave + 2;
}

std::vector<FeatureMatch> findSources(const std::vector<Source>& sources, const TrackedFrame& last,
                                      const SE3& T_camera_world, double radius_px, const FrameTrackerConfig& config,
                                      const TrackedFrame& current, std::vector<int>& source_of_query) {
  std::vector<GuidedQuery> queries;
  source_of_query.clear();
  for (int s = 0; s < static_cast<int>(sources.size()); ++s) {
    const Eigen::Vector3d p = T_camera_world * sources[s].point_world;
    if (p.z() < kMinProjectionDepthM) continue;
    const Eigen::Vector2d px = current.camera->projectUndistorted(p);
    if (!current.camera->contains(px)) continue;
    const Feature& feature = last.feature(sources[s].feature);
    GuidedQuery query;
    query.descriptor = last.features->descriptors.ptr(sources[s].feature);
    query.predicted_px = px.cast<float>();
    query.radius_px = static_cast<float>(radius_px * pyramidScale(feature.octave));
    query.depth_m = static_cast<float>(p.z());
    query.angle_rad = feature.angle_rad;
    setOctaveRange((last.T_camera_world * sources[s].point_world).z(), p.z(), feature.octave, query);
    queries.push_back(query);
    source_of_query.push_back(s);
  }
  GuidedSearchConfig search;
  search.virtual_bf_px_m = static_cast<float>(current.camera->fx() * config.sensor.virtual_baseline_m);
  return searchGuided(queries, *current.features, current.grid, {}, search);
}

}  // namespace

PoseEstimate trackFromLastFrame(const Map& map, const TrackedFrame& last, const SE3& predicted_T_camera_world,
                                const FrameTrackerConfig& config, TrackedFrame& current) {
  const auto sources = collectSources(map, last);
  std::vector<int> source_of_query;
  auto matches =
      findSources(sources, last, predicted_T_camera_world, config.search_radius_px, config, current, source_of_query);
  if (static_cast<int>(matches.size()) < config.minimum_matches) {
    matches = findSources(sources, last, predicted_T_camera_world, 2.0 * config.search_radius_px, config, current,
                          source_of_query);
  }
  if (static_cast<int>(matches.size()) < config.minimum_matches) {
    return estimateFrom({}, static_cast<int>(matches.size()));
  }

  PoseProblem problem = startProblem(current, predicted_T_camera_world, config);
  for (const auto& match : matches) {
    const Source& source = sources[source_of_query[match.query]];
    problem.observations.push_back(makeObservation(current.feature(match.feature), source.point_world, source.trust));
  }
  const PoseSolution solution = optimizePose(problem, config.pose);
  if (solution.usable) {
    current.T_camera_world = solution.T_camera_world;
    for (std::size_t i = 0; i < matches.size(); ++i) {
      if (solution.inlier[i]) {
        current.landmarks[matches[i].feature] = sources[source_of_query[matches[i].query]].landmark;
      }
    }
  }
  return estimateFrom(solution, static_cast<int>(matches.size()));
}

PoseEstimate trackFromKeyframe(const Map& map, const Keyframe& keyframe, const SE3& start_T_camera_world,
                               const FrameTrackerConfig& config, TrackedFrame& current) {
  std::vector<bool> has_landmark(keyframe.landmarks.size());
  for (std::size_t i = 0; i < has_landmark.size(); ++i) has_landmark[i] = keyframe.landmarks[i].valid();
  constexpr float kRatio = 0.7F;  // Lowe's test; positions are not used here, so it must be strict
  const auto matches =
      matchBruteForce(*keyframe.features, has_landmark, *current.features, {}, kMaxDistanceStrict, kRatio);
  if (static_cast<int>(matches.size()) < config.minimum_matches) {
    return estimateFrom({}, static_cast<int>(matches.size()));
  }
  for (const auto& match : matches) current.landmarks[match.feature] = keyframe.landmarks[match.query];
  current.T_camera_world = start_T_camera_world;
  return refinePose(map, config, current);
}

}  // namespace semantic_vslam
