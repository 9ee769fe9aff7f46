// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/dense/map_objects.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

/// A square of n x n points, 1 cm apart, with its corner at (x, y, 1).
std::vector<LabelledPoint> square(float x, float y, int n, std::uint8_t label) {
  std::vector<LabelledPoint> points;
  for (int i = 0; i < n * n; ++i) {
    LabelledPoint point;
    point.xyz_m = cv::Vec3f(x + 0.01F * static_cast<float>(i % n), y + 0.01F * static_cast<float>(i / n), 1.0F);
    point.label = label;
    points.push_back(point);
  }
  return points;
}

std::vector<LabelledPoint> join(std::vector<LabelledPoint> a, const std::vector<LabelledPoint>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

TEST(MapObjects, SquareIsOneObjectWithItsCentroidAndBox) {
  const auto objects = findObjects(square(-0.1F, 0.2F, 21, 3), MapObjectsConfig());
  ASSERT_EQ(objects.size(), 1U);
  EXPECT_EQ(objects[0].label, 3);
  EXPECT_EQ(objects[0].points, 441);
  EXPECT_LT((objects[0].centroid_m - Eigen::Vector3d(0.0, 0.3, 1.0)).norm(), 0.01);
  EXPECT_TRUE(objects[0].box_m.min().isApprox(Eigen::Vector3d(-0.1, 0.2, 1.0), 1e-5));
  EXPECT_TRUE(objects[0].box_m.max().isApprox(Eigen::Vector3d(0.1, 0.4, 1.0), 1e-5));
}

TEST(MapObjects, GapOfTwoCellsSeparatesAndTouchingClassesStayApart) {
  const auto apart = join(square(0.0F, 0.0F, 20, 2), square(0.4F, 0.0F, 20, 2));
  EXPECT_EQ(findObjects(apart, MapObjectsConfig()).size(), 2U);
  const auto classes = findObjects(join(square(0.0F, 0.0F, 20, 5), square(0.2F, 0.0F, 20, 4)), MapObjectsConfig());
  ASSERT_EQ(classes.size(), 2U);
  EXPECT_EQ(classes[0].label, 4);
  EXPECT_EQ(classes[1].label, 5);
}

/// The same, standing: along x and z.
std::vector<LabelledPoint> screen(float x, int n, std::uint8_t label) {
  std::vector<LabelledPoint> points = square(x, 0.0F, n, label);
  for (LabelledPoint& point : points) point.xyz_m = cv::Vec3f(point.xyz_m[0], 0.0F, 1.0F + point.xyz_m[1]);
  return points;
}

TEST(MapObjects, PiecesOfATableTopAreOneTableAndScreensSideBySideAreTwo) {
  // A book lies across the table: 16 cm without points of it, but for its edge 8 cm beside.
  const auto table = join(square(0.0F, 0.0F, 30, 10), square(0.38F, 0.0F, 30, 10));
  ASSERT_EQ(findObjects(table, MapObjectsConfig()).size(), 1U);
  EXPECT_NEAR(findObjects(table, MapObjectsConfig())[0].centroid_m.x(), 0.335, 0.01);
  EXPECT_EQ(findObjects(join(screen(0.0F, 30, 3), screen(0.47F, 30, 3)), MapObjectsConfig()).size(), 2U);
}

TEST(MapObjects, ScreensThatAlmostTouchAreTwo) {
  const auto objects = findObjects(join(screen(0.0F, 40, 3), screen(0.45F, 40, 3)), MapObjectsConfig());
  ASSERT_EQ(objects.size(), 2U);
  EXPECT_NEAR(std::abs(objects[0].centroid_m.x() - objects[1].centroid_m.x()), 0.45, 0.02);
  EXPECT_EQ(findObjects(screen(0.0F, 80, 3), MapObjectsConfig()).size(), 1U) << "a wide one";
}

TEST(MapObjects, DenserPointsOnOneSideDoNotMoveTheCentroid) {
  auto points = square(0.0F, 0.0F, 40, 2);
  for (int i = 0; i < 5; ++i) points = join(points, square(0.0F, 0.0F, 20, 2));
  EXPECT_LT((findObjects(points, MapObjectsConfig())[0].centroid_m - Eigen::Vector3d(0.195, 0.195, 1.0)).norm(), 0.02);
}

TEST(MapObjects, TheBoxIsTurnedAsTheThingIs) {
  auto points = square(0.0F, 0.0F, 60, 10);
  points.erase(points.begin() + 60 * 20, points.end());  // 0.6 x 0.2 m
  for (LabelledPoint& point : points) {
    const Eigen::Vector3d turned = Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ()) * Eigen::Vector3d(point.position());
    point.xyz_m = cv::Vec3f(static_cast<float>(turned.x()), static_cast<float>(turned.y()), 1.0F);
  }
  const MapObject object = findObjects(points, MapObjectsConfig()).at(0);
  EXPECT_NEAR(object.size_m.head<2>().maxCoeff(), 0.59, 0.02);
  EXPECT_NEAR(object.size_m.head<2>().minCoeff(), 0.19, 0.02);
  EXPECT_NEAR(std::sin(2.0 * (object.yaw_rad - 0.5)), 0.0, 0.05) << "but for quarter turns";
}

TEST(MapObjects, ConfidenceAndTimeComeFromTheSurface) {
  const auto evidence = [](const Eigen::Vector3d& p) {
    return SurfaceEvidence{p.x() < 0.2 ? 1.0 : 0.5, Stamp::fromSeconds(p.x() < 0.1 ? 7.0 : 3.0)};
  };
  const MapObject object = findObjects(square(0.0F, 0.0F, 40, 2), MapObjectsConfig(), evidence).at(0);
  EXPECT_NEAR(object.confidence, 0.75, 0.03);
  EXPECT_EQ(object.last_seen, Stamp::fromSeconds(7.0));
}

TEST(ObjectList, AnObjectKeepsItsIdWhileItGrowsGoesAndComesBack) {
  const auto chair = square(0.0F, 0.0F, 30, 2), table = square(2.0F, 0.0F, 60, 10);
  ObjectList list;
  auto both = findObjects(join(chair, table), MapObjectsConfig());
  list.giveIds(both);
  const std::uint32_t chair_id = both[0].id, table_id = both[1].id;
  EXPECT_NE(chair_id, table_id);
  auto alone = findObjects(square(2.0F, 0.0F, 70, 10), MapObjectsConfig());
  list.giveIds(alone);
  EXPECT_EQ(alone[0].id, table_id);
  both = findObjects(join(join(chair, square(0.9F, 0.0F, 30, 2)), table), MapObjectsConfig());
  list.giveIds(both);
  ASSERT_EQ(both.size(), 3U);
  EXPECT_EQ(both[0].id, chair_id);
  EXPECT_GT(both[1].id, table_id) << "a second chair";
  EXPECT_EQ(both[2].id, table_id);
}

TEST(ObjectList, AClosedLoopMovesObjectsAndTheirIds) {
  ObjectList list;
  auto objects = findObjects(square(0.0F, 0.0F, 30, 2), MapObjectsConfig());
  list.giveIds(objects);
  SE3 T = SE3::Identity();
  T.translation().x() = 2.0;
  auto after = findObjects(square(2.0F, 0.0F, 30, 2), MapObjectsConfig());
  list.giveIds(after, [&](const MapObject&) { return T; });
  EXPECT_EQ(after[0].id, objects[0].id);
}

TEST(MapObjects, ASeatAndItsFootAreOneChair) {
  auto foot = square(0.05F, 0.05F, 25, 2);
  for (LabelledPoint& point : foot) point.xyz_m[2] = 0.65F;  // the stem between them was not seen
  EXPECT_EQ(findObjects(join(square(0.0F, 0.0F, 40, 2), foot), MapObjectsConfig()).size(), 1U);
}

TEST(MapObjects, BackgroundAndSpecksMakeNoObject) {
  EXPECT_TRUE(findObjects(square(0.0F, 0.0F, 30, 0), MapObjectsConfig()).empty());
  EXPECT_TRUE(findObjects(square(0.0F, 0.0F, 9, 1), MapObjectsConfig()).empty());
  EXPECT_TRUE(findObjects({}, MapObjectsConfig()).empty());
}

TEST(MapObjects, OrderOfThePointsDoesNotMatter) {
  auto cloud = join(square(0.5F, 0.0F, 20, 2), square(-1.0F, 0.0F, 20, 2));
  const auto forward = findObjects(cloud, MapObjectsConfig());
  std::reverse(cloud.begin(), cloud.end());
  const auto backward = findObjects(cloud, MapObjectsConfig());
  ASSERT_EQ(forward.size(), 2U);
  ASSERT_EQ(backward.size(), 2U);
  for (int i = 0; i < 2; ++i) EXPECT_TRUE(forward[i].box_m.isApprox(backward[i].box_m));
}

TEST(MapObjects, BadConfigIsRefused) {
  MapObjectsConfig config;
  config.cell_m = 0.0;
  EXPECT_THROW(findObjects({}, config), ConfigError);
}

}  // namespace
}  // namespace semantic_vslam
