// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/loop/map_joiner.h"

#include <algorithm>
#include <map>
#include <utility>

#include "semantic_vslam/core/common/log.h"

namespace semantic_vslam {
namespace {

constexpr int kAgreeing = 3;
// Twice the spread of a pose found by relocalisation (RelocalisationConfig::max_sigma_m), seen from either side.
constexpr double kMaxApartM = 0.05, kMaxApartRad = 0.05;
// Every so many frames are looked up: it takes as long as tracking does.
constexpr int kSeekEvery = 3;

}  // namespace

bool joinTrees(Map& map, LoopClosure& closure) {
  const KeyframeId current_root = map.rootOf(closure.current), matched_root = map.rootOf(closure.matched);
  if (current_root == matched_root) return false;
  const SE3 T_current_own = map.keyframe(closure.current)->T_camera_world;
  const SE3 T_matched_own = closure.T_current_world.inverse() * T_current_own;  // of the worlds of both trees
  if (matched_root < current_root) {
    map.moveTree(current_root, T_matched_own);
    map.hangTree(closure.current, closure.matched);
  } else {
    map.moveTree(matched_root, T_matched_own.inverse());
    map.hangTree(closure.matched, closure.current);
    closure.T_current_world = T_current_own;
  }
  logInfo("the new map is joined with the old one");
  return true;
}

std::vector<KeyframeId> abandonedTrees(const Map& map, KeyframeId camera_at, int min_keyframes, double min_s) {
  struct Extent {
    int keyframes = 0;
    Stamp first, last;
  };
  std::map<KeyframeId, Extent> trees;
  for (const auto& [id, root] : map.roots()) {
    Extent& tree = trees[root];
    const Stamp stamp = map.keyframe(id)->stamp;
    tree.first = tree.keyframes == 0 ? stamp : std::min(tree.first, stamp);
    tree.last = tree.keyframes == 0 ? stamp : std::max(tree.last, stamp);
    ++tree.keyframes;
  }
  const KeyframeId own_root = map.rootOf(camera_at);
  std::vector<KeyframeId> abandoned;
  for (const auto& [root, tree] : trees) {
    const bool little = tree.keyframes < min_keyframes || secondsBetween(tree.first, tree.last) < min_s;
    if (little && root != own_root) abandoned.push_back(root);
  }
  return abandoned;
}

bool JoinEvidence::add(const SE3& T_new_camera, const SE3& T_old_camera) {
  const SE3 difference = (T_old_new_ * T_new_camera).inverse() * T_old_camera;
  const bool agrees = difference.translation().norm() <= kMaxApartM && rotationAngle(difference) <= kMaxApartRad;
  agreeing_ = agreeing_ > 0 && agrees ? agreeing_ + 1 : 1;
  T_old_new_ = T_old_camera * T_new_camera.inverse();
  return agreeing_ >= kAgreeing;
}

std::optional<LoopClosure> WorldSeeker::seek(const Map& map, const PlaceIndex& places, const TrackedFrame& frame,
                                             const SE3& T_camera_own) {
  if (frames_++ % kSeekEvery != 0) return std::nullopt;
  auto found =
      relocalise(map, places, frame, tracker_, relocalisation_, [&map](KeyframeId id) { return map.isPlaced(id); });
  if (!found || !evidence_.add(T_camera_own.inverse(), found->T_camera_world.inverse())) return std::nullopt;
  LoopClosure closure;
  closure.matched = found->keyframe;
  closure.T_current_world = found->T_camera_world;
  closure.T_current_matched = found->T_camera_world * map.keyframe(found->keyframe)->T_camera_world.inverse();
  closure.landmarks = std::move(found->landmarks);
  return closure;
}

}  // namespace semantic_vslam
