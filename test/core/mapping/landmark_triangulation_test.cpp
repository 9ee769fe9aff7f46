// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/mapping/landmark_triangulation.h"

#include <gtest/gtest.h>

#include "core/support/synthetic_map.h"

namespace semantic_vslam {
namespace {

/// Two views of a room's wall, 0.4 m apart; some features have landmarks by depth, which makes the views neighbours,
/// the others are made as if the sensor had measured nothing.
struct TwoViews {
  SyntheticWorld world{3};
  Map map;
  KeyframeId first, second;
  std::vector<int> point_of_first, point_of_second;  ///< per feature, index into the world's points

  explicit TwoViews(float static_weight = 1.0F, double baseline_m = 0.4) {
    for (int i = 0; i < 400; ++i) {
      world.addPoint({world.rng().uniform(-2, 2), world.rng().uniform(-1.5, 1.5), world.rng().uniform(2.5, 5.0)});
    }
    SE3 T_second_world = SE3::Identity();
    T_second_world.translation().x() = -baseline_m;
    first = add(SE3::Identity(), point_of_first, static_weight);
    second = add(T_second_world, point_of_second, static_weight);
  }

  KeyframeId add(const SE3& T_camera_world, std::vector<int>& point_of, float static_weight) {
    const SyntheticWorld::View view = world.observe(T_camera_world, {});
    point_of = view.point_of;
    Keyframe keyframe;
    keyframe.T_camera_world = T_camera_world;
    keyframe.camera = world.camera();
    keyframe.features = view.features;
    keyframe.landmarks.assign(view.features->size(), LandmarkId());
    for (std::size_t i = 0; i < point_of.size(); ++i) {
      Feature& feature = view.features->features[i];
      const bool measured = point_of[i] % 4 == 0;
      if (measured && landmark_of_.count(point_of[i]) > 0) keyframe.landmarks[i] = landmark_of_[point_of[i]];
      if (measured) continue;
      feature.depth_m = 0.0F;
      feature.static_weight = static_weight;
    }
    const KeyframeId id = map.addKeyframe(keyframe);
    for (std::size_t i = 0; i < point_of.size(); ++i) {
      if (point_of[i] % 4 != 0 || map.keyframe(id)->landmarks[i].valid()) continue;
      landmark_of_[point_of[i]] = map.addLandmark(world.points()[point_of[i]].position, id, static_cast<int>(i));
    }
    return id;
  }

 private:
  std::unordered_map<int, LandmarkId> landmark_of_;
};

TEST(TriangulateNewLandmarks, PlacesPointsThatNoDepthWasMeasuredOf) {
  TwoViews views;
  const std::size_t before = views.map.landmarks().size();
  const int made = triangulateNewLandmarks(views.map, views.second, SensorConfig(), TriangulationConfig());
  EXPECT_GT(made, 60);
  EXPECT_EQ(views.map.landmarks().size(), before + made);
  int right = 0;
  for (const auto& [id, landmark] : views.map.landmarks()) {
    if (landmark.created_in != views.second || landmark.reference_keyframe != views.second) continue;
    if (landmark.observations.size() != 2) continue;
    const int point = views.point_of_second[landmark.observations.at(views.second)];
    if (views.point_of_first[landmark.observations.at(views.first)] != point) continue;
    // Half a pixel at 4 m and 0.4 m apart: 4^2 / (0.4 * 517) * 0.5 px = 4 cm, times the scale of the level.
    EXPECT_LT((landmark.position_world - views.world.points()[point].position).norm(), 0.4);
    ++right;
  }
  EXPECT_GE(right, made * 98 / 100);
}

TEST(TriangulateNewLandmarks, LeavesOutWhatMayMove) {
  TwoViews views(0.2F);
  EXPECT_EQ(triangulateNewLandmarks(views.map, views.second, SensorConfig(), TriangulationConfig()), 0);
}

TEST(TriangulateNewLandmarks, NeedsParallax) {
  TwoViews views(1.0F, 0.02);  // 0.02 m at 2.5 m and more: at most 0.46 degrees
  EXPECT_EQ(triangulateNewLandmarks(views.map, views.second, SensorConfig(), TriangulationConfig()), 0);
}

TEST(TriangulateNewLandmarks, CanBeSwitchedOff) {
  TwoViews views;
  TriangulationConfig config;
  config.neighbours = 0;
  EXPECT_EQ(triangulateNewLandmarks(views.map, views.second, SensorConfig(), config), 0);
}

}  // namespace
}  // namespace semantic_vslam
