// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/loop/loop_detector.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "core/features/matcher.h"
#include "core/map/visibility.h"
#include "semantic_vslam/core/common/config_fields.h"

namespace semantic_vslam {
namespace {

constexpr int kMinShared = 15;

Eigen::Vector3d centreOf(const SE3& T_camera_world) { return T_camera_world.inverse().translation(); }

/// The keyframe, those that share any landmark with it, and the neighbours of these: what tracking connects already.
std::set<KeyframeId> surroundings(const Map& map, KeyframeId id) {
  std::set<KeyframeId> around = {id};
  for (const auto& [neighbour, shared] : map.covisible(id, 1)) {
    around.insert(neighbour);
    if (shared < kMinShared) continue;
    for (const auto& [second, second_shared] : map.covisible(neighbour, kMinShared)) {
      around.insert(second);
    }
  }
  return around;
}

/// The score that the keyframe's own neighbours reach at least; 0 if it has none.
double leastNeighbourScore(const Map& map, const std::vector<PlaceMatch>& matches, KeyframeId id) {
  std::set<KeyframeId> neighbours;
  for (const auto& [neighbour, shared] : map.covisible(id, 2 * kMinShared)) {
    neighbours.insert(neighbour);
  }
  double least = neighbours.empty() ? 0.0 : 1.0;
  for (const auto& match : matches) {
    if (neighbours.count(match.keyframe) > 0) least = std::min(least, match.score);
  }
  return least;
}

/// Keyframes outside the surroundings that look like the keyframe, best first.
std::vector<KeyframeId> similarKeyframes(const Map& map, const PlaceIndex& index, const Keyframe& current,
                                         const std::set<KeyframeId>& around, const LoopDetectorConfig& config) {
  const auto matches = index.query(*current.features, static_cast<int>(index.size()));
  const double bound =
      std::max(config.min_score, config.min_score_share * leastNeighbourScore(map, matches, current.id));
  std::vector<KeyframeId> similar;
  for (const auto& match : matches) {
    if (match.score < bound || static_cast<int>(similar.size()) >= config.max_candidates) break;
    if (around.count(match.keyframe) == 0 && map.keyframe(match.keyframe) != nullptr) similar.push_back(match.keyframe);
  }
  return similar;
}

/// Length of the camera's way from one keyframe to a later one, metres.
double wayBetween(const Map& map, KeyframeId from, KeyframeId to) {
  double way_m = 0.0;
  const auto& keyframes = map.keyframes();
  for (auto it = keyframes.find(from); it != keyframes.end() && it->first < to; ++it) {
    const auto next = std::next(it);
    if (next == keyframes.end()) break;
    way_m += (centreOf(it->second.T_camera_world) - centreOf(next->second.T_camera_world)).norm();
  }
  return way_m;
}

LoopClosure closureOf(const Map& map, const Keyframe& current, const RelocalisationResult& place) {
  LoopClosure closure;
  closure.current = current.id;
  closure.matched = place.keyframe;
  closure.T_current_world = place.T_camera_world;
  closure.T_current_matched = place.T_camera_world * map.keyframe(place.keyframe)->T_camera_world.inverse();
  closure.landmarks = place.landmarks;
  return closure;
}

/// Looks for landmarks in a keyframe as if it were at a pose.
LandmarkSightings lookFor(const Map& map, const std::vector<LandmarkId>& landmarks, const Keyframe& keyframe,
                          const SE3& T_camera_world, double radius_px, double virtual_baseline_m) {
  TrackedFrame frame = frameOf(keyframe);
  frame.T_camera_world = T_camera_world;
  LandmarkSearch search;
  search.radius_px = search.oblique_radius_px = radius_px;
  search.matching.max_distance = kMaxDistanceStrict;
  search.matching.virtual_bf_px_m = static_cast<float>(keyframe.camera->fx() * virtual_baseline_m);
  return findLandmarks(map, landmarks, frame, search);
}

}  // namespace

LoopDetector::LoopDetector(const LoopDetectorConfig& config, const FramePoseConfig& tracker)
    : config_(config), tracker_(tracker) {
  validateConfig(config_);
  validateConfig(tracker_);
}

std::optional<LoopClosure> LoopDetector::detect(const Map& map, const PlaceIndex& index, KeyframeId current_id) {
  const Keyframe* current = map.keyframe(current_id);
  if (current == nullptr) return std::nullopt;
  if (unsure_since_) {
    if (auto closure = compareWithBefore(map, index, *current)) return closure;
  }
  const auto around = surroundings(map, current_id);
  const auto similar = similarKeyframes(map, index, *current, around, config_);
  for (const KeyframeId candidate : consistentCandidates(map, similar)) {
    if (auto closure = verify(map, *current, candidate, around)) return closure;
  }
  return std::nullopt;
}

void LoopDetector::noteKeyframe(KeyframeId id, double found_share) {
  if (found_share >= config_.sure_share) return;
  if (!unsure_since_) unsure_since_ = id;
  last_unsure_ = id;
}

std::optional<LoopClosure> LoopDetector::compareWithBefore(const Map& map, const PlaceIndex& index,
                                                           const Keyframe& current) {
  const auto isBefore = [&](KeyframeId id) { return id < *unsure_since_; };
  const auto found = findAmong(map, index, current, isBefore);
  if (!found) return std::nullopt;
  const SE3& T_current_world = found->place.T_camera_world;
  if ((centreOf(T_current_world) - centreOf(current.T_camera_world)).norm() < config_.same_place_m) {
    if (last_unsure_ < current.id) unsure_since_.reset();
    return std::nullopt;
  }
  if (!driftExplains(map, current, found->place.keyframe, T_current_world) ||
      !neighboursConfirm(map, current, found->group, T_current_world)) {
    return std::nullopt;
  }
  return closureOf(map, current, found->place);
}

std::optional<LoopDetector::Found> LoopDetector::findAmong(const Map& map, const PlaceIndex& index,
                                                           const Keyframe& current,
                                                           const std::function<bool(KeyframeId)>& among) const {
  std::optional<Found> best;
  std::set<KeyframeId> covered;
  int tried = 0;
  for (const auto& match : index.query(*current.features, static_cast<int>(index.size()))) {
    if (tried >= config_.verification.max_candidates || match.score < config_.min_score) break;
    if (!among(match.keyframe) || covered.count(match.keyframe) > 0 || map.keyframe(match.keyframe) == nullptr ||
        map.rootOf(match.keyframe) != map.rootOf(current.id)) {
      continue;
    }
    ++tried;
    const auto nearest = keyframeGroup(map, match.keyframe, 2);  // would be verified by nearly the same landmarks
    covered.insert(nearest.begin(), nearest.end());
    auto group = keyframeGroup(map, match.keyframe, config_.verification.neighbours);
    group.erase(std::remove_if(group.begin(), group.end(), [&](KeyframeId id) { return !among(id); }), group.end());
    auto place = relocaliseAt(map, group, frameOf(current), tracker_, config_.verification);
    if (place && (!best || place->inliers > best->place.inliers)) best = Found{std::move(*place), std::move(group)};
  }
  return best;
}

/// Extends the chains of keyframes that pointed at one place.
/// @return one candidate for each place whose chain is long enough, best first
std::vector<KeyframeId> LoopDetector::consistentCandidates(const Map& map, const std::vector<KeyframeId>& candidates) {
  std::vector<Chain> chains;
  std::vector<KeyframeId> consistent;
  std::set<KeyframeId> covered;
  for (const KeyframeId candidate : candidates) {
    const auto ids = keyframeGroup(map, candidate, config_.verification.neighbours);
    Chain chain{{ids.begin(), ids.end()}, 1};
    for (const Chain& before : chains_) {
      const bool linked =
          std::any_of(ids.begin(), ids.end(), [&](KeyframeId id) { return before.group.count(id) > 0; });
      if (linked) chain.length = std::max(chain.length, before.length + 1);
    }
    const bool room_for_more = static_cast<int>(consistent.size()) < config_.verification.max_candidates;
    if (chain.length >= config_.consistent_keyframes && room_for_more && covered.count(candidate) == 0) {
      consistent.push_back(candidate);
      const auto nearest = keyframeGroup(map, candidate, 2);  // would be verified by nearly the same landmarks
      covered.insert(nearest.begin(), nearest.end());
    }
    chains.push_back(std::move(chain));
  }
  chains_ = std::move(chains);
  return consistent;
}

std::optional<LoopClosure> LoopDetector::verify(const Map& map, const Keyframe& current, KeyframeId candidate,
                                                const std::set<KeyframeId>& around_current) const {
  auto group = keyframeGroup(map, candidate, config_.verification.neighbours);
  group.erase(std::remove_if(group.begin(), group.end(), [&](KeyframeId id) { return around_current.count(id) > 0; }),
              group.end());
  const auto found = relocaliseAt(map, group, frameOf(current), tracker_, config_.verification);
  if (!found || !driftExplains(map, current, candidate, found->T_camera_world)) return std::nullopt;
  if (!neighboursConfirm(map, current, group, found->T_camera_world)) return std::nullopt;
  return closureOf(map, current, *found);
}

bool LoopDetector::driftExplains(const Map& map, const Keyframe& current, KeyframeId candidate,
                                 const SE3& T_current_world) const {
  if (map.rootOf(current.id) != map.rootOf(candidate)) return true;  // nothing is known yet of where the one map lies
  const double way_m = wayBetween(map, std::min(candidate, current.id), std::max(candidate, current.id));
  const double moved_m = (centreOf(T_current_world) - centreOf(current.T_camera_world)).norm();
  const double turned_rad = rotationAngle(T_current_world * current.T_camera_world.inverse());
  return moved_m <= config_.max_drift_base_m + config_.max_drift_share * way_m &&
         turned_rad <= config_.max_drift_base_rad + config_.max_drift_rad_per_m * way_m;
}

bool LoopDetector::neighboursConfirm(const Map& map, const Keyframe& current, const std::vector<KeyframeId>& group,
                                     const SE3& T_current_world) const {
  const auto landmarks = landmarksSeenBy(map, group);
  int confirmed = 0, able = 0, asked = 0;
  for (const auto& [id, shared] : map.covisible(current.id, kMinShared)) {
    if (confirmed >= config_.confirming_neighbours || asked++ >= 2 * config_.confirming_neighbours) break;
    const Keyframe& neighbour = *map.keyframe(id);
    const SE3 T_neighbour_world = neighbour.T_camera_world * current.T_camera_world.inverse() * T_current_world;
    const auto seen = lookFor(map, landmarks, neighbour, T_neighbour_world, config_.confirming_radius_px,
                              tracker_.sensor.virtual_baseline_m);
    const auto expected = static_cast<int>(seen.visible.size()), found = static_cast<int>(seen.found.size());
    // One that looks elsewhere cannot confirm; where keyframes are few, fewer than wanted can.
    able += expected >= 2 * config_.min_confirming_matches ? 1 : 0;
    confirmed += found >= config_.min_confirming_matches ? 1 : 0;
  }
  return confirmed >= std::clamp(able, std::min(1, config_.confirming_neighbours), config_.confirming_neighbours);
}

}  // namespace semantic_vslam
