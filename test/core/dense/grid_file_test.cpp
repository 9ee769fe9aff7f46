// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/dense/grid_file.h"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <cstdio>
#include <opencv2/imgcodecs.hpp>

#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

/// What map_server's loader makes of a pixel (mode trinary).
std::int8_t loaded(std::uint8_t grey, const YAML::Node& map) {
  const double occupied = (255 - grey) / 255.0;
  if (occupied > map["occupied_thresh"].as<double>()) return OccupancyGrid::kOccupied;
  if (occupied < map["free_thresh"].as<double>()) return OccupancyGrid::kFree;
  return OccupancyGrid::kUnknown;
}

TEST(GridFile, MapServerReadsTheSameGrid) {
  OccupancyGrid grid;
  grid.width = 3;
  grid.height = 2;
  grid.resolution_m = 0.06;
  grid.origin_x_m = -1.2;
  grid.origin_y_m = 3.4;
  grid.cells = {0, 100, -1, 100, 100, 0};
  const std::string name = testing::TempDir() + "grid_file_test";
  writeGrid(grid, name);
  const YAML::Node map = YAML::LoadFile(name + ".yaml");
  const cv::Mat image = cv::imread(testing::TempDir() + map["image"].as<std::string>(), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(image.size(), cv::Size(3, 2));
  EXPECT_DOUBLE_EQ(map["resolution"].as<double>(), 0.06);
  EXPECT_DOUBLE_EQ(map["origin"][0].as<double>(), -1.2);
  EXPECT_DOUBLE_EQ(map["origin"][1].as<double>(), 3.4);
  EXPECT_EQ(map["negate"].as<int>(), 0);
  for (int y = 0; y < 2; ++y) {
    for (int x = 0; x < 3; ++x)
      EXPECT_EQ(loaded(image.at<std::uint8_t>(1 - y, x), map), grid.at(x, y)) << x << " " << y;
  }
  std::remove((name + ".pgm").c_str());
  std::remove((name + ".yaml").c_str());
}

TEST(GridFile, AGridWithoutCellsIsNoMap) {
  EXPECT_THROW(writeGrid(OccupancyGrid(), testing::TempDir() + "grid_file_test"), Error);
}

}  // namespace
}  // namespace semantic_vslam
