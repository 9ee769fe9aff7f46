// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/loop/map_joiner.h"

#include <gtest/gtest.h>

#include "core/support/synthetic_map.h"

namespace semantic_vslam {
namespace {

SE3 poseAt(double x_m) {
  SE3 T_camera_world = SE3::Identity();
  T_camera_world.translation().x() = -x_m;
  return T_camera_world;
}

/// Two trees of four keyframes each in one room, the second in a frame of reference of its own.
struct TwoTrees {
  SyntheticWorld world{5};
  SyntheticMap synthetic;
  std::vector<KeyframeId> old_side, new_side;
  SE3 T_other_world = se3Exp((Vector6d() << 4, -2, 1, 0.5, 0.2, -1.0).finished());

  TwoTrees() {
    world.addRoom({0, 0, 2}, {6, 4, 6}, 1200);
    for (int i = 0; i < 4; ++i) old_side.push_back(add(0.2 * i, SE3::Identity()));
    synthetic.landmark_of.clear();
    for (int i = 0; i < 4; ++i) new_side.push_back(add(0.2 * i + 0.1, T_other_world));
  }
  KeyframeId add(double x_m, const SE3& T_tree_world) {
    SyntheticWorld::Noise none{0.0, 0.0, 0};
    return addKeyframe(world, synthetic, poseAt(x_m), poseAt(x_m) * T_tree_world.inverse(), none);
  }
  /// The one keyframe as the other's landmarks place it.
  LoopClosure closure(KeyframeId current, KeyframeId matched, const SE3& T_tree_world_of_matched) const {
    LoopClosure closure;
    closure.current = current;
    closure.matched = matched;
    closure.T_current_world = synthetic.true_T_camera_world[current.value()] * T_tree_world_of_matched.inverse();
    closure.T_current_matched = closure.T_current_world * synthetic.map.keyframe(matched)->T_camera_world.inverse();
    return closure;
  }
  void expectOneTrueMap() const {
    const Map& map = synthetic.map;
    for (const auto& [id, keyframe] : map.keyframes()) {
      EXPECT_TRUE(map.isPlaced(id)) << id.value();
      const SE3& truth = synthetic.true_T_camera_world[id.value()];
      EXPECT_TRUE(keyframe.T_camera_world.isApprox(truth, 1e-9)) << id.value();
    }
    for (const auto& [id, landmark] : map.landmarks()) {
      const Eigen::Vector3d& truth = world.points()[synthetic.point_of.at(id)].position;
      EXPECT_LT((landmark.position_world - truth).norm(), 1e-4);
      const double cosine = landmark.mean_view_direction.dot(
          (truth - synthetic.true_T_camera_world[landmark.reference_keyframe.value()].inverse().translation())
              .normalized());
      EXPECT_GT(cosine, 0.9) << "view directions turn with the tree";
    }
  }
};

TEST(JoinTrees, MovesTheYoungerTreeToTheOlderOne) {
  TwoTrees trees;
  Map& map = trees.synthetic.map;
  ASSERT_EQ(map.rootOf(trees.new_side[3]), trees.new_side[0]);
  ASSERT_FALSE(map.isPlaced(trees.new_side[2]));
  const std::uint64_t version = map.version();
  LoopClosure closure = trees.closure(trees.new_side[2], trees.old_side[1], SE3::Identity());
  EXPECT_TRUE(joinTrees(map, closure));
  trees.expectOneTrueMap();
  EXPECT_EQ(map.keyframe(trees.new_side[2])->parent, trees.old_side[1]);
  EXPECT_GT(map.version(), version) << "adjustments under way are refused";
  EXPECT_FALSE(joinTrees(map, closure)) << "they are one now";
}

TEST(JoinTrees, TheOlderTreeStaysWhicheverSideSeesTheOther) {
  TwoTrees trees;
  LoopClosure closure = trees.closure(trees.old_side[3], trees.new_side[1], trees.T_other_world);
  EXPECT_TRUE(joinTrees(trees.synthetic.map, closure));
  trees.expectOneTrueMap();
  EXPECT_TRUE(closure.T_current_world.isApprox(trees.synthetic.true_T_camera_world[trees.old_side[3].value()], 1e-9));
}

TEST(JoinTrees, TheFirstKeyframeOfATreeStaysUntilItIsJoined) {
  TwoTrees trees;
  Map& map = trees.synthetic.map;
  map.removeKeyframe(trees.new_side[0]);
  EXPECT_NE(map.keyframe(trees.new_side[0]), nullptr);
  LoopClosure closure = trees.closure(trees.new_side[2], trees.old_side[1], SE3::Identity());
  joinTrees(map, closure);
  map.removeKeyframe(trees.new_side[0]);
  EXPECT_EQ(map.keyframe(trees.new_side[0]), nullptr);
  for (const KeyframeId id : trees.new_side) {
    if (map.keyframe(id) != nullptr) {
      EXPECT_TRUE(map.isPlaced(id));
    }
  }
}

TEST(AbandonedTrees, AreSmallAndNotTheCamerasOwn) {
  TwoTrees trees;
  const Map& map = trees.synthetic.map;
  EXPECT_EQ(abandonedTrees(map, trees.old_side[2], 5, 0.0), (std::vector<KeyframeId>{trees.new_side[0]}));
  EXPECT_TRUE(abandonedTrees(map, trees.old_side[2], 4, 0.0).empty()) << "four keyframes are enough";
  EXPECT_EQ(abandonedTrees(map, trees.new_side[1], 5, 0.0), (std::vector<KeyframeId>{trees.old_side[0]}))
      << "four keyframes are too few for a world, too";
  const double span_s = secondsBetween(map.keyframe(trees.new_side[0])->stamp, map.keyframe(trees.new_side[3])->stamp);
  EXPECT_TRUE(abandonedTrees(map, trees.old_side[2], 4, span_s).empty());
  EXPECT_EQ(abandonedTrees(map, trees.old_side[2], 4, span_s + 0.1), (std::vector<KeyframeId>{trees.new_side[0]}))
      << "many keyframes of one moment show one view";
}

TEST(JoinEvidence, IsSettledWhenThreeFramesAgreeOnWhereTheNewMapLies) {
  const SE3 T_old_new = se3Exp((Vector6d() << 3, 1, 0, 0, 0, 0.7).finished());
  JoinEvidence evidence;
  EXPECT_FALSE(evidence.add(poseAt(0.0), T_old_new * poseAt(0.0)));
  EXPECT_FALSE(evidence.add(poseAt(0.5), T_old_new * poseAt(0.5)));
  EXPECT_TRUE(evidence.add(poseAt(1.0), T_old_new * poseAt(1.02)));
}

TEST(JoinEvidence, FramesThatDisagreeBeginAnew) {
  const SE3 T_old_new = se3Exp((Vector6d() << 3, 1, 0, 0, 0, 0.7).finished());
  JoinEvidence evidence;
  EXPECT_FALSE(evidence.add(poseAt(0.0), T_old_new * poseAt(0.0)));
  EXPECT_FALSE(evidence.add(poseAt(0.5), T_old_new * poseAt(0.5)));
  EXPECT_FALSE(evidence.add(poseAt(1.0), T_old_new * poseAt(1.3)));
  EXPECT_FALSE(evidence.add(poseAt(1.5), T_old_new * poseAt(1.5)));
  EXPECT_FALSE(evidence.add(poseAt(2.0), T_old_new * poseAt(2.0)));
  EXPECT_TRUE(evidence.add(poseAt(2.5), T_old_new * poseAt(2.5)));
}

}  // namespace
}  // namespace semantic_vslam
