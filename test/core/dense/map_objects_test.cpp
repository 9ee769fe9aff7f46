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
  EXPECT_TRUE(objects[0].centroid_m.isApprox(Eigen::Vector3d(0.0, 0.3, 1.0), 1e-5));
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
  EXPECT_NEAR(findObjects(table, MapObjectsConfig())[0].centroid_m.x(), 0.335, 0.005);
  EXPECT_EQ(findObjects(join(screen(0.0F, 30, 3), screen(0.47F, 30, 3)), MapObjectsConfig()).size(), 2U);
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
