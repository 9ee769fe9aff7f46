// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "semantic_vslam/core/loop/map_joiner.h"

namespace semantic_vslam {
namespace {

constexpr int kAgreeing = 3;
// Twice the spread of a pose found by relocalisation (RelocalizerConfig::max_sigma_m), seen from either side.
constexpr double kMaxApartM = 0.05, kMaxApartRad = 0.05;

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
  return true;
}

bool JoinEvidence::add(const SE3& T_new_camera, const SE3& T_old_camera) {
  const SE3 difference = (T_old_new_ * T_new_camera).inverse() * T_old_camera;
  const bool agrees = difference.translation().norm() <= kMaxApartM && rotationAngle(difference) <= kMaxApartRad;
  agreeing_ = agreeing_ > 0 && agrees ? agreeing_ + 1 : 1;
  T_old_new_ = T_old_camera * T_new_camera.inverse();
  return agreeing_ >= kAgreeing;
}

}  // namespace semantic_vslam
