// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "eval/map_score.h"

#include <gtest/gtest.h>

#include <cmath>

#include "eval/map_picture.h"

namespace semantic_vslam {
namespace {

using synthetic::makeBox;
using synthetic::makeEllipsoid;
using synthetic::makeFrustum;
using synthetic::makeRoundedCone;
using synthetic::Primitive;

/// A floor of 4 x 4 m and a table of 1 x 1 m, 0.7 m high and 4 cm thick, without legs.
synthetic::Primitives floorAndTable() {
  synthetic::Scene scene;
  synthetic::Primitives all = scene.numbered({makeBox({0, 0, -0.05F}, {4, 4, 0.1F}, 0, synthetic::kBackground)});
  synthetic::append(all, scene.numbered({makeBox({1, 0, 0.7F}, {1, 1, 0.04F}, 0, synthetic::kTable)}));
  return all;
}

LabelledPoint at(float x, float y, float z) { return {cv::Vec3f(x, y, z), {}, 0}; }

TEST(SignedDistance, IsThatToTheSurfaceOfEachShape) {
  const Primitive box = makeBox({0, 0, 0}, {2, 2, 2}, 0, 0);
  EXPECT_NEAR(signedDistance(box, {1.5, 0, 0}), 0.5, 1e-6);
  EXPECT_NEAR(signedDistance(box, {2, 2, 0}), std::sqrt(2.0), 1e-6);
  EXPECT_NEAR(signedDistance(box, {0.8, 0, 0}), -0.2, 1e-6);
  const Primitive ball = makeEllipsoid({0, 0, 0}, {0.5F, 0.5F, 0.5F}, 0, 0);
  EXPECT_NEAR(signedDistance(ball, {0, 0, 0.6}), 0.1, 1e-6);
  const Primitive cylinder = makeFrustum({0, 0, 0}, 0.2F, 0.2F, 1.0F, 0, 0);
  EXPECT_NEAR(signedDistance(cylinder, {0.3, 0, 0.5}), 0.1, 1e-6);
  EXPECT_NEAR(signedDistance(cylinder, {0, 0, 1.1}), 0.1, 1e-6);
  EXPECT_NEAR(signedDistance(cylinder, {0.15, 0, 0.5}), -0.05, 1e-6);
  const Primitive capsule = makeRoundedCone({0, 0, 0}, 0.1F, {0, 0, 1}, 0.1F, 0, 0);
  EXPECT_NEAR(signedDistance(capsule, {0.3, 0, 0.5}), 0.2, 1e-6);
  EXPECT_NEAR(signedDistance(capsule, {0, 0, 1.3}), 0.2, 1e-6);
}

TEST(RoomTruth, TellsTheNearestThingAndWhatStandsWhere) {
  const RoomTruth truth(floorAndTable());
  EXPECT_NEAR(truth.nearest({1, 0, 0.75}).distance_m, 0.03, 1e-6);
  EXPECT_EQ(truth.nearest({1, 0, 0.75}).label, synthetic::kTable);
  EXPECT_EQ(truth.nearest({1, 0, 0.03}).thing, 0);
  EXPECT_EQ(truth.nearest({1, 0, 0.3}).distance_m, RoomTruth::kReachM);
  EXPECT_TRUE(truth.obstacleOver(1, 0, 0.1, 1.8));
  EXPECT_FALSE(truth.obstacleOver(-1, 0, 0.1, 1.8));
}

TEST(ScoreGrid, CountsFreeCellsOnATable) {
  OccupancyGrid grid;
  grid.width = grid.height = 40;
  grid.resolution_m = 0.1;
  grid.origin_x_m = grid.origin_y_m = -2.0;
  grid.cells.assign(1600, OccupancyGrid::kFree);
  grid.cells[0] = OccupancyGrid::kOccupied;
  const GridScore score = scoreGrid(grid, 0.1, 1.8, RoomTruth(floorAndTable()));
  EXPECT_EQ(score.free, 1599);
  EXPECT_EQ(score.free_on_obstacle, 100);
  EXPECT_EQ(score.occupied_on_free, 1);
  EXPECT_EQ(score.passable_known, 1499);
  EXPECT_GT(cv::countNonZero(drawGrid(grid, 0.1, 1.8, RoomTruth(floorAndTable())).reshape(1)), 0);
}

TEST(CompareWithEmptyRoom, CountsWhatIsLeftOverAndWhatIsFoundAgain) {
  std::vector<LabelledPoint> empty, map;
  for (int i = 0; i < 100; ++i) empty.push_back(at(0.05F * static_cast<float>(i), 0.01F, 0.01F));
  map.assign(empty.begin(), empty.begin() + 90);
  for (int i = 0; i < 10; ++i) map.push_back(at(0.05F * static_cast<float>(i), 0.5F, 0.01F));
  const RoomComparison comparison = compareWithEmptyRoom(map, empty);
  EXPECT_NEAR(comparison.left_over, 0.10, 1e-9);
  EXPECT_NEAR(comparison.found_again, 0.90, 1e-9);
  EXPECT_EQ(comparison.left_over_points.size(), 10U);
}

}  // namespace
}  // namespace semantic_vslam
