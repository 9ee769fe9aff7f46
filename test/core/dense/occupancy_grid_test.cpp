// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/dense/occupancy_grid.h"

#include <gtest/gtest.h>

#include <cmath>

#include "dense_scene.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

/// The camera looks along +x of the map, 1 m above its floor: z forward -> x, x right -> -y, y down -> -z.
SE3 mapFromCamera() {
  SE3 T = SE3::Identity();
  T.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  T.translation() = Eigen::Vector3d(0.0, 0.0, 1.0);
  return T;
}

VoxelMap roomMap(const RgbdFrame& frame) {
  VoxelMapConfig config;
  config.resolution_m = 0.1;
  VoxelMap map(config);
  KeyframeCloudConfig cloud_config;
  cloud_config.stride_px = 1;
  const auto cloud = makeKeyframeCloud(KeyframeId(0), frame, cv::Mat1b(), cv::Mat1b(), cloud_config);
  map.integrate(cloud.points, makeFreeSpaceView(frame, cv::Mat1b(), cv::Mat1b(), KeyframeCloudConfig(), 2),
                SE3::Identity());
  return map;
}

/// A band that the camera sees all of from 1.2 m on: 48 rows of 1/50 rad.
OccupancyGridConfig tenCentimetres() {
  OccupancyGridConfig config;
  config.resolution_m = 0.1;
  config.min_height_m = 0.6;
  config.max_height_m = 1.4;
  config.max_gap_m = 0.2;
  return config;
}

/// Of a map that is looked at once.
OccupancyGrid projectToGrid(const VoxelMap& map, const SE3& T_map_world, const OccupancyGridConfig& config,
                            const Floor& floor) {
  GridProjection projection;
  projection.update(map);
  return projection.project(T_map_world, config, floor);
}

OccupancyGrid projectToGrid(const VoxelMap& map, const SE3& T_map_world, const OccupancyGridConfig& config) {
  return projectToGrid(map, T_map_world, config, Floor{Eigen::Vector3d::UnitZ(), config.floor_height_m});
}

std::int8_t cellAt(const OccupancyGrid& grid, double x_m, double y_m) {
  const int x = static_cast<int>(std::floor((x_m - grid.origin_x_m) / grid.resolution_m));
  const int y = static_cast<int>(std::floor((y_m - grid.origin_y_m) / grid.resolution_m));
  const bool inside = x >= 0 && y >= 0 && x < grid.width && y < grid.height;
  return inside ? grid.at(x, y) : OccupancyGrid::kUnknown;
}

TEST(OccupancyGrid, ShowsWallFreeAndUnknownFromAbove) {
  const OccupancyGrid grid = projectToGrid(roomMap(wallFrame(3.05F)), mapFromCamera(), tenCentimetres());
  for (const double y : {-1.05, 0.05, 1.05}) EXPECT_EQ(cellAt(grid, 3.05, y), OccupancyGrid::kOccupied) << y;
  EXPECT_EQ(cellAt(grid, 1.55, 0.05), OccupancyGrid::kFree);
  EXPECT_EQ(cellAt(grid, 2.55, -0.55), OccupancyGrid::kFree);
  EXPECT_EQ(cellAt(grid, 1.05, 1.55), OccupancyGrid::kUnknown);  // beside the view
  EXPECT_EQ(cellAt(grid, 3.45, 0.05), OccupancyGrid::kUnknown);  // behind the wall
  // The wall ends the grid: columns 0..63 at 3.05 m reach from y = 1.95 to -1.89.
  EXPECT_NEAR(grid.origin_x_m + grid.width * grid.resolution_m, 3.1, 1e-9);
  EXPECT_NEAR(grid.origin_y_m, -1.9, 1e-9);
  EXPECT_EQ(grid.cells.size(), static_cast<std::size_t>(grid.width) * grid.height);
}

TEST(OccupancyGrid, OnlyTheHeightBandCounts) {
  // A beam at 1.5 m (z of the camera frame 2.05, 0.5 m above the axis), with the wall behind.
  RgbdFrame frame = wallFrame(3.05F);
  frame.depth_m.rowRange(9, 14) = 2.05F;  // (9 .. 13 - 24) / 50 * 2.05 = -0.62 .. -0.45 m
  const VoxelMap map = roomMap(frame);
  OccupancyGridConfig config = tenCentimetres();
  config.max_height_m = 1.8;
  EXPECT_EQ(cellAt(projectToGrid(map, mapFromCamera(), config), 2.05, 0.05), OccupancyGrid::kOccupied);
  config.max_height_m = 1.2;  // a robot that passes below
  EXPECT_EQ(cellAt(projectToGrid(map, mapFromCamera(), config), 2.05, 0.05), OccupancyGrid::kFree);
  config.floor_height_m = 0.4;  // the same band, 0.4 m higher
  EXPECT_EQ(cellAt(projectToGrid(map, mapFromCamera(), config), 2.05, 0.05), OccupancyGrid::kOccupied);
  Floor floor;  // a floor that is tilted: 0.4 m higher where the beam is
  floor.up = Eigen::Vector3d(-0.4 / 2.05, 0.0, 1.0).normalized();
  config.floor_height_m = 0.0;
  EXPECT_EQ(cellAt(projectToGrid(map, mapFromCamera(), config, floor), 2.05, 0.05), OccupancyGrid::kOccupied);
}

TEST(OccupancyGrid, AColumnThatIsNotKnownFromEndToEndIsUnknown) {
  OccupancyGridConfig config = tenCentimetres();
  config.min_height_m = 0.1;
  config.max_height_m = 1.8;
  const VoxelMap map = roomMap(wallFrame(3.05F));
  const OccupancyGrid grid = projectToGrid(map, mapFromCamera(), config);
  EXPECT_EQ(cellAt(grid, 1.05, 0.05), OccupancyGrid::kUnknown);  // sees 0.5 .. 1.5 m
  EXPECT_EQ(cellAt(grid, 2.55, 0.05), OccupancyGrid::kFree);
}

TEST(OccupancyGrid, WhatIsEdgeOnToTheCameraIsNotFree) {
  // A desk top at the height of the camera: no ray ends on it, and none passes within 15 cm of it.
  RgbdFrame frame = wallFrame(3.05F);
  frame.depth_m.rowRange(21, 28) = 0.0F;
  const OccupancyGrid grid = projectToGrid(roomMap(frame), mapFromCamera(), tenCentimetres());
  EXPECT_EQ(cellAt(grid, 2.55, 0.05), OccupancyGrid::kUnknown);
}

TEST(OccupancyGrid, AnEmptyMapIsAnEmptyGrid) {
  const OccupancyGrid grid = projectToGrid(VoxelMap(VoxelMapConfig()), SE3::Identity(), OccupancyGridConfig());
  EXPECT_EQ(grid.width, 0);
  EXPECT_TRUE(grid.cells.empty());
}

TEST(OccupancyGrid, RefusesABandUpsideDown) {
  OccupancyGridConfig config;
  config.min_height_m = 2.0;
  EXPECT_THROW(projectToGrid(VoxelMap(VoxelMapConfig()), SE3::Identity(), config), ConfigError);
}

TEST(OccupancyGrid, WhatIsFarFromAllElseMakesNoGridOfGigabytes) {
  const RgbdFrame frame = wallFrame(2.02F);
  VoxelMapConfig config;
  config.resolution_m = 0.1;
  VoxelMap map(config);
  KeyframeCloudConfig cloud_config;
  cloud_config.stride_px = 1;
  const auto cloud = makeKeyframeCloud(KeyframeId(0), frame, cv::Mat1b(), cv::Mat1b(), cloud_config);
  const FreeSpaceView view = makeFreeSpaceView(frame, cv::Mat1b(), cv::Mat1b(), cloud_config, 2);
  for (const double x_m : {-0.5, 0.0, 0.5, 3000.0}) {
    map.integrate(cloud.points, view, SE3(Eigen::Translation3d(x_m, 0.0, 0.0)));
  }
  const OccupancyGrid grid = projectToGrid(map, mapFromCamera(), tenCentimetres());
  EXPECT_LT(grid.width, 100);
  EXPECT_LT(grid.height, 100);
  EXPECT_EQ(cellAt(grid, 2.05, 0.05), OccupancyGrid::kOccupied);
}

}  // namespace
}  // namespace semantic_vslam
