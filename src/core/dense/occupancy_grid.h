// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "core/dense/voxel_map.h"

namespace semantic_vslam {

struct OccupancyGridConfig {
  double resolution_m = 0.06;
  double floor_height_m = 0.0;
  double min_height_m = 0.10;
  double max_height_m = 1.80;
  double free_height_m = 0.10;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("resolution_m", resolution_m, 0.01, 1.0,
            "edge of a cell; at least sqrt(3) voxels, or a turned voxel grid leaves holes");
    v.field("floor_height_m", floor_height_m, -100.0, 100.0, "height of the floor in the map frame");
    v.field("min_height_m", min_height_m, -10.0, 10.0,
            "lower edge of the band above the floor that counts; above door sills and depth noise of the floor");
    v.field("max_height_m", max_height_m, -10.0, 10.0, "upper edge of the band: the robot's height and a margin");
    v.field("free_height_m", free_height_m, 0.0, 10.0,
            "a cell is free if at least this height of its band is known to be; less is unknown");
  }
};

/// A nav_msgs/OccupancyGrid in the terms of the core.
struct OccupancyGrid {
  static constexpr std::int8_t kUnknown = -1, kFree = 0, kOccupied = 100;
  int width = 0, height = 0;  ///< cells along x and y of the map frame
  double resolution_m = 0.0;
  double origin_x_m = 0.0, origin_y_m = 0.0;  ///< of the outer corner of cell (0, 0)
  std::vector<std::int8_t> cells;             ///< cell (x, y) at y * width + x

  std::int8_t at(int x, int y) const { return cells[static_cast<std::size_t>(y) * width + x]; }
};

/// Looks down on a height band of the map. A cell is occupied if any voxel of its band is; free if enough of it is
/// known to be free; else unknown. The grid covers all that is known in the band; it has no cells where nothing is.
/// @param T_map_world  into a frame with z up: only the caller knows gravity
/// @throws ConfigError
OccupancyGrid projectToGrid(const VoxelMap& map, const SE3& T_map_world, const OccupancyGridConfig& config);

}  // namespace semantic_vslam
