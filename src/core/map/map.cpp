// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/map/map.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>
#include <utility>

namespace semantic_vslam {
namespace {

// More observations than this do not make the medoid descriptor better, and its cost is quadratic.
constexpr std::size_t kMaxMedoidObservations = 12;

/// The descriptor with the smallest median distance to the others (Mur-Artal and Tardos 2015, section V).
cv::Mat1b medoidDescriptor(const std::vector<cv::Mat1b>& descriptors) {
  std::size_t best = 0;
  int best_median = 257;
  for (std::size_t i = 0; i < descriptors.size(); ++i) {
    std::vector<int> distances;
    for (const auto& other : descriptors) {
      distances.push_back(descriptorDistance(descriptors[i].ptr(), other.ptr()));
    }
    const auto middle = distances.begin() + static_cast<std::ptrdiff_t>((distances.size() - 1) / 2);
    std::nth_element(distances.begin(), middle, distances.end());
    if (*middle < best_median) {
      best_median = *middle;
      best = i;
    }
  }
  return descriptors[best].clone();
}

/// Every n-th observation, so that at most kMaxMedoidObservations stay; the newest is always among them.
std::vector<std::pair<KeyframeId, int>> sampleObservations(const std::map<KeyframeId, int>& observations) {
  const std::size_t step = (observations.size() + kMaxMedoidObservations - 1) / kMaxMedoidObservations;
  std::vector<std::pair<KeyframeId, int>> sample;
  std::size_t i = 0;
  for (auto it = observations.rbegin(); it != observations.rend(); ++it, ++i) {
    if (i % step == 0) sample.push_back(*it);
  }
  return sample;
}

}  // namespace

Keyframe* Map::mutableKeyframe(KeyframeId id) {
  const auto it = keyframes_.find(id);
  return it == keyframes_.end() ? nullptr : &it->second;
}

Landmark* Map::mutableLandmark(LandmarkId id) {
  const auto it = landmarks_.find(id);
  return it == landmarks_.end() ? nullptr : &it->second;
}

const Keyframe* Map::keyframe(KeyframeId id) const {
  const auto it = keyframes_.find(id);
  return it == keyframes_.end() ? nullptr : &it->second;
}

const Landmark* Map::landmark(LandmarkId id) const {
  const auto it = landmarks_.find(id);
  return it == landmarks_.end() ? nullptr : &it->second;
}

KeyframeId Map::addKeyframe(Keyframe keyframe) {
  assert(keyframe.features && keyframe.camera);
  const KeyframeId id(next_keyframe_++);
  keyframe.id = id;
  const std::vector<LandmarkId> matches = std::move(keyframe.landmarks);
  keyframe.landmarks.assign(keyframe.features->size(), LandmarkId());
  keyframes_.emplace(id, std::move(keyframe));
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (matches[i].valid()) addObservation(id, static_cast<int>(i), matches[i]);
  }
  const auto neighbours = covisible(id, 1);
  if (!neighbours.empty()) mutableKeyframe(id)->parent = neighbours.front().first;
  return id;
}

LandmarkId Map::addLandmark(const Eigen::Vector3d& position_world, KeyframeId seen_by, int feature_index) {
  const LandmarkId id(next_landmark_++);
  Landmark landmark;
  landmark.id = id;
  landmark.position_world = position_world;
  landmark.reference_keyframe = seen_by;
  landmark.created_in = keyframes_.rbegin()->first;
  landmarks_.emplace(id, std::move(landmark));
  const bool added = addObservation(seen_by, feature_index, id);
  assert(added);
  static_cast<void>(added);
  refreshLandmark(id);
  return id;
}

bool Map::addObservation(KeyframeId keyframe_id, int feature_index, LandmarkId landmark_id) {
  Keyframe* keyframe = mutableKeyframe(keyframe_id);
  Landmark* landmark = mutableLandmark(landmark_id);
  if (!keyframe || !landmark || keyframe->landmarks[feature_index].valid()) return false;
  if (!landmark->observations.emplace(keyframe_id, feature_index).second) return false;
  keyframe->landmarks[feature_index] = landmark_id;
  for (const auto& [other, index] : landmark->observations) {
    if (other == keyframe_id) continue;
    ++shared_[keyframe_id][other];
    ++shared_[other][keyframe_id];
  }
  return true;
}

void Map::removeObservation(KeyframeId keyframe_id, LandmarkId landmark_id) {
  Keyframe* keyframe = mutableKeyframe(keyframe_id);
  Landmark* landmark = mutableLandmark(landmark_id);
  if (!keyframe || !landmark) return;
  const auto observation = landmark->observations.find(keyframe_id);
  if (observation == landmark->observations.end()) return;
  keyframe->landmarks[observation->second] = LandmarkId();
  landmark->observations.erase(observation);
  for (const auto& [other, index] : landmark->observations) {
    for (const auto& [a, b] : {std::pair(keyframe_id, other), std::pair(other, keyframe_id)}) {
      auto& weights = shared_[a];
      if (--weights[b] <= 0) weights.erase(b);
    }
  }
  if (landmark->observations.empty()) {
    landmarks_.erase(landmark_id);
  } else if (landmark->reference_keyframe == keyframe_id) {
    landmark->reference_keyframe = landmark->observations.begin()->first;
  }
}

void Map::removeLandmark(LandmarkId id) {
  const Landmark* gone = landmark(id);
  if (!gone) return;
  const auto observations = gone->observations;
  for (const auto& [keyframe_id, index] : observations) {
    removeObservation(keyframe_id, id);  // the last one erases the landmark
  }
}

void Map::removeKeyframe(KeyframeId id) {
  const Keyframe* gone = keyframe(id);
  if (!gone || !gone->parent.valid()) return;
  const KeyframeId parent = gone->parent;
  for (const KeyframeId child : children(id)) mutableKeyframe(child)->parent = parent;
  forgetKeyframe(id);
}

std::vector<KeyframeId> Map::removeTree(KeyframeId root) {
  std::vector<KeyframeId> members;
  for (const auto& [id, own_root] : roots()) {
    if (own_root == root) members.push_back(id);
  }
  std::sort(members.begin(), members.end());
  for (const KeyframeId id : members) forgetKeyframe(id);
  return members;
}

/// Removes a keyframe, its observations and the loop edges to it; the spanning tree is the caller's matter.
void Map::forgetKeyframe(KeyframeId id) {
  const auto matches = keyframe(id)->landmarks;
  for (const LandmarkId landmark_id : matches) {
    if (landmark_id.valid()) removeObservation(id, landmark_id);
  }
  for (auto& [other_id, other] : keyframes_) {
    auto& edges = other.loop_edges;
    edges.erase(std::remove(edges.begin(), edges.end(), id), edges.end());
  }
  shared_.erase(id);
  keyframes_.erase(id);
}

void Map::fuseLandmarks(LandmarkId from, LandmarkId into) {
  if (from == into || !landmark(from) || !landmark(into)) return;
  const Landmark moved = *landmark(from);
  removeLandmark(from);
  for (const auto& [keyframe_id, index] : moved.observations) addObservation(keyframe_id, index, into);
  Landmark* target = mutableLandmark(into);
  target->visible_count += moved.visible_count;
  target->found_count += moved.found_count;
  refreshLandmark(into);
}

void Map::clear() {
  keyframes_.clear();
  landmarks_.clear();
  shared_.clear();
  origin_ = {};
  ++version_;
}

void Map::restore(std::map<KeyframeId, Keyframe> keyframes, std::unordered_map<LandmarkId, Landmark> landmarks,
                  std::uint64_t next_keyframe, std::uint64_t next_landmark) {
  clear();
  keyframes_ = std::move(keyframes);
  landmarks_ = std::move(landmarks);
  next_keyframe_ = next_keyframe;
  next_landmark_ = next_landmark;
  for (auto& [id, keyframe] : keyframes_) {
    keyframe.landmarks.assign(keyframe.features->size(), LandmarkId());
  }
  for (const auto& [landmark_id, landmark] : landmarks_) {
    for (auto first = landmark.observations.begin(); first != landmark.observations.end(); ++first) {
      keyframes_.at(first->first).landmarks[first->second] = landmark_id;
      for (auto second = std::next(first); second != landmark.observations.end(); ++second) {
        ++shared_[first->first][second->first];
        ++shared_[second->first][first->first];
      }
    }
  }
}

std::vector<std::pair<KeyframeId, int>> Map::covisible(KeyframeId id, int minimum_shared) const {
  std::vector<std::pair<KeyframeId, int>> neighbours;
  const auto weights = shared_.find(id);
  if (weights == shared_.end()) return neighbours;
  for (const auto& [other, count] : weights->second) {
    if (count >= minimum_shared) neighbours.emplace_back(other, count);
  }
  std::sort(neighbours.begin(), neighbours.end(), [](const auto& a, const auto& b) {
    return a.second != b.second ? a.second > b.second : b.first < a.first;
  });
  return neighbours;
}

std::vector<KeyframeId> Map::children(KeyframeId id) const {
  std::vector<KeyframeId> found;
  for (const auto& [other_id, other] : keyframes_) {
    if (other.parent == id) found.push_back(other_id);
  }
  return found;
}

KeyframeId Map::rootOf(KeyframeId id) const {
  const Keyframe* member = keyframe(id);
  while (member && member->parent.valid()) member = keyframe(member->parent);
  return member ? member->id : KeyframeId();
}

std::unordered_map<KeyframeId, KeyframeId> Map::roots() const {
  std::unordered_map<KeyframeId, KeyframeId> roots;
  std::vector<KeyframeId> way;
  for (const auto& [id, keyframe] : keyframes_) {
    KeyframeId at = id;
    while (roots.count(at) == 0) {
      way.push_back(at);
      const KeyframeId parent = keyframes_.at(at).parent;
      if (!parent.valid()) break;
      at = parent;
    }
    const auto known = roots.find(at);
    const KeyframeId root = known == roots.end() ? at : known->second;
    for (const KeyframeId passed : way) roots[passed] = root;
    way.clear();
  }
  return roots;
}

bool Map::apply(const MapSolution& solution, std::uint64_t version) {
  if (version != version_) return false;
  for (const auto& [id, T_camera_world] : solution.T_camera_world) setPose(id, T_camera_world);
  for (const auto& [id, position] : solution.position_world) setPosition(id, position);
  for (const auto& [keyframe_id, landmark_id] : solution.outlier_observations) {
    removeObservation(keyframe_id, landmark_id);
  }
  for (const auto& [id, position] : solution.position_world) {
    refreshGeometry(id);
  }
  return true;
}

void Map::setPose(KeyframeId id, const SE3& T_camera_world) {
  if (Keyframe* found = mutableKeyframe(id)) found->T_camera_world = T_camera_world;
}

void Map::setPosition(LandmarkId id, const Eigen::Vector3d& position_world) {
  if (Landmark* found = mutableLandmark(id)) found->position_world = position_world;
}

void Map::addLoopEdge(KeyframeId a, KeyframeId b) {
  Keyframe *first = mutableKeyframe(a), *second = mutableKeyframe(b);
  if (!first || !second) return;
  first->loop_edges.push_back(b);
  second->loop_edges.push_back(a);
}

void Map::moveTree(KeyframeId root, const SE3& T_new_old) {
  std::set<LandmarkId> seen;
  const auto root_of = roots();
  for (auto& [id, keyframe] : keyframes_) {
    if (root_of.at(id) != root) continue;
    keyframe.T_camera_world = keyframe.T_camera_world * T_new_old.inverse();
    for (const LandmarkId landmark : keyframe.landmarks) {
      if (landmark.valid()) seen.insert(landmark);
    }
  }
  for (const LandmarkId id : seen) {
    Landmark* moved = mutableLandmark(id);
    moved->position_world = T_new_old * moved->position_world;
    refreshGeometry(id);
  }
  bumpVersion();
}

void Map::hangTree(KeyframeId member, KeyframeId parent) {
  assert(keyframe(member) && keyframe(parent) && rootOf(member) != rootOf(parent));
  // The way from the member up to its root is turned round.
  while (member.valid()) {
    Keyframe* turned = mutableKeyframe(member);
    const KeyframeId next = turned->parent;
    turned->parent = parent;
    parent = member;
    member = next;
  }
}

void Map::countVisible(LandmarkId id) {
  if (Landmark* found = mutableLandmark(id)) ++found->visible_count;
}

void Map::countFound(LandmarkId id) {
  if (Landmark* found = mutableLandmark(id)) ++found->found_count;
}

void Map::refreshGeometry(LandmarkId id) {
  Landmark* target = mutableLandmark(id);
  if (!target) return;
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  for (const auto& [keyframe_id, index] : target->observations) {
    const SE3 T_world_camera = keyframe(keyframe_id)->T_camera_world.inverse();
    direction += (target->position_world - T_world_camera.translation()).normalized();
  }
  target->mean_view_direction = direction.normalized();

  // Scale invariance range: the distance at which the point would fall on the finest and the coarsest pyramid level.
  const Keyframe& reference = *keyframe(target->reference_keyframe);
  const int octave = reference.features->features[target->observations.at(reference.id)].octave;
  const double distance = (reference.T_camera_world * target->position_world).norm();
  target->max_distance_m = distance * std::pow(kPyramidScale, octave);
  target->min_distance_m = target->max_distance_m / std::pow(kPyramidScale, kPyramidLevels - 1);
}

void Map::refreshLandmark(LandmarkId id) {
  Landmark* target = mutableLandmark(id);
  if (!target) return;
  std::vector<cv::Mat1b> descriptors;
  for (const auto& [keyframe_id, index] : sampleObservations(target->observations)) {
    descriptors.push_back(keyframe(keyframe_id)->features->descriptors.row(index));
  }
  target->descriptor = medoidDescriptor(descriptors);
  refreshGeometry(id);
}

}  // namespace semantic_vslam
