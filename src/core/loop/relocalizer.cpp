// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/loop/relocalizer.h"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <iterator>
#include <set>
#include <utility>

#include "core/features/matcher.h"
#include "core/map/visibility.h"

namespace semantic_vslam {
namespace {

// Fewer shared landmarks are often wrong matches (Mur-Artal and Tardos 2015, section III.D).
constexpr int kMinShared = 15;
constexpr int kCellColumns = 8, kCellRows = 6;

/// Matches of the frame with the keyframe's landmarks by descriptor alone, entered into the frame.
int matchByDescriptor(const Map& map, const Keyframe& keyframe, const RelocalisationConfig& config,
                      TrackedFrame& frame) {
  std::vector<bool> has_landmark(keyframe.landmarks.size());
  for (std::size_t i = 0; i < has_landmark.size(); ++i) {
    has_landmark[i] = keyframe.landmarks[i].valid() && map.landmark(keyframe.landmarks[i]) != nullptr;
  }
  const auto matches = matchBruteForce(*keyframe.features, has_landmark, *frame.features, {}, kMaxDistanceStrict,
                                       static_cast<float>(config.match_ratio));
  for (const auto& match : matches) frame.landmarks[match.feature] = keyframe.landmarks[match.query];
  return static_cast<int>(matches.size());
}

PoseProblem makeProblem(const Map& map, const TrackedFrame& frame, const FramePoseConfig& tracker) {
  PoseProblem problem;
  problem.camera = frame.camera->intrinsics();
  problem.sensor = tracker.sensor;
  for (std::size_t i = 0; i < frame.landmarks.size(); ++i) {
    const Landmark* landmark = frame.landmarks[i].valid() ? map.landmark(frame.landmarks[i]) : nullptr;
    if (landmark == nullptr) continue;
    const Feature& feature = frame.feature(static_cast<int>(i));
    problem.observations.push_back({landmark->position_world, feature.undistorted_px.cast<double>(), feature.depth_m,
                                    pyramidScale(feature.octave), feature.static_weight});
  }
  return problem;
}

/// Looks for landmarks that the frame has no match of yet, at its present pose.
void addGuidedMatches(const Map& map, const std::vector<LandmarkId>& landmarks, double radius_px,
                      const FramePoseConfig& tracker, TrackedFrame& frame) {
  const std::set<LandmarkId> known(frame.landmarks.begin(), frame.landmarks.end());
  std::vector<LandmarkId> missing;
  std::copy_if(landmarks.begin(), landmarks.end(), std::back_inserter(missing),
               [&known](LandmarkId id) { return known.count(id) == 0; });
  LandmarkSearch search;
  search.radius_px = search.oblique_radius_px = radius_px;
  search.matching.virtual_bf_px_m = static_cast<float>(frame.camera->fx() * tracker.sensor.virtual_baseline_m);
  for (const auto& [id, feature] : findLandmarks(map, missing, frame, search).found) frame.landmarks[feature] = id;
}

int occupiedCells(const TrackedFrame& frame) {
  std::bitset<kCellColumns * kCellRows> occupied;
  for (std::size_t i = 0; i < frame.landmarks.size(); ++i) {
    if (!frame.landmarks[i].valid()) continue;
    const Eigen::Vector2f& px = frame.feature(static_cast<int>(i)).undistorted_px;
    const int column = std::clamp(static_cast<int>(px.x() * kCellColumns / frame.camera->width()), 0, kCellColumns - 1);
    const int row = std::clamp(static_cast<int>(px.y() * kCellRows / frame.camera->height()), 0, kCellRows - 1);
    occupied.set(row * kCellColumns + column);
  }
  return static_cast<int>(occupied.count());
}

bool isSure(const PoseEstimate& estimate, const TrackedFrame& frame, const RelocalisationConfig& config) {
  const double sigma_m = std::sqrt(estimate.covariance.diagonal().head<3>().maxCoeff());
  return estimate.success && estimate.inliers >= config.min_inliers && sigma_m <= config.max_sigma_m &&
         occupiedCells(frame) >= config.min_cells;
}

double distanceBetween(const SE3& a, const SE3& b) {
  return (a.inverse().translation() - b.inverse().translation()).norm();
}

}  // namespace

std::vector<KeyframeId> keyframeGroup(const Map& map, KeyframeId id, int neighbours) {
  std::vector<KeyframeId> group;
  if (map.keyframe(id) == nullptr) return group;
  group.push_back(id);
  for (const auto& [neighbour, shared] : map.covisible(id, kMinShared)) {
    if (static_cast<int>(group.size()) > neighbours) break;
    group.push_back(neighbour);
  }
  return group;
}

std::optional<RelocalisationResult> relocaliseAt(const Map& map, const std::vector<KeyframeId>& group,
                                                 const TrackedFrame& frame, const FramePoseConfig& tracker,
                                                 const RelocalisationConfig& config) {
  if (group.empty() || map.keyframe(group.front()) == nullptr) return std::nullopt;
  TrackedFrame working = frame;
  working.landmarks.assign(working.features->size(), LandmarkId());
  if (matchByDescriptor(map, *map.keyframe(group.front()), config, working) < config.ransac.min_inliers) {
    return std::nullopt;
  }
  const auto start = findPose(makeProblem(map, working, tracker), config.ransac);
  if (!start) return std::nullopt;
  working.T_camera_world = *start;

  PoseEstimate estimate = refinePose(map, tracker, working);
  const std::vector<LandmarkId> landmarks = landmarksSeenBy(map, group);
  for (const double radius_px : {config.wide_radius_px, config.narrow_radius_px}) {
    if (!estimate.success) return std::nullopt;
    addGuidedMatches(map, landmarks, radius_px, tracker, working);
    estimate = refinePose(map, tracker, working);
  }
  if (!isSure(estimate, working, config)) return std::nullopt;
  return RelocalisationResult{working.T_camera_world, estimate.covariance, group.front(), estimate.inliers,
                              std::move(working.landmarks)};
}

std::optional<RelocalisationResult> relocalise(const Map& map, const PlaceIndex& index, const TrackedFrame& frame,
                                               const FramePoseConfig& tracker, const RelocalisationConfig& config,
                                               const std::function<bool(KeyframeId)>& among) {
  std::vector<RelocalisationResult> found;
  std::set<KeyframeId> explained;  // shown by a pose found already
  // Neighbours look alike too, so several times as many are asked for as are tried.
  int tried = 0;
  const int asked = among ? static_cast<int>(index.size()) : 10 * config.max_candidates;
  for (const auto& match : index.query(*frame.features, asked)) {
    if (tried >= config.max_candidates) break;
    if (explained.count(match.keyframe) > 0 || (among && !among(match.keyframe))) continue;
    const auto group = keyframeGroup(map, match.keyframe, config.neighbours);
    ++tried;
    auto result = relocaliseAt(map, group, frame, tracker, config);
    if (!result) continue;
    for (const KeyframeId id : keyframeGroup(map, match.keyframe, static_cast<int>(map.keyframes().size()))) {
      explained.insert(id);
    }
    found.push_back(std::move(*result));
  }
  if (found.empty()) return std::nullopt;
  const auto best =
      std::max_element(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.inliers < b.inliers; });
  for (const auto& other : found) {
    const bool another_place = distanceBetween(other.T_camera_world, best->T_camera_world) > config.ambiguity_m;
    if (another_place && other.inliers >= config.ambiguity_share * best->inliers) return std::nullopt;
  }
  return std::move(*best);
}

}  // namespace semantic_vslam
