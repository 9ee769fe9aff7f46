// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/dense/occupancy_grid.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <tuple>

#include "semantic_vslam/core/common/config_fields.h"
#include "semantic_vslam/core/common/error.h"
#include "semantic_vslam/core/common/log.h"

namespace semantic_vslam {
namespace {

/// One known voxel of the height band.
struct BandVoxel {
  int x, y, layer;  // cells of the grid, from any origin; layer counts voxels upwards
  bool occupied;
};

std::vector<BandVoxel> voxelsInBand(const VoxelMap& map, const SE3& T_map_world, const OccupancyGridConfig& config,
                                    const Floor& floor) {
  std::vector<BandVoxel> band;
  map.forEachKnown([&](const Voxel& voxel) {
    const Eigen::Vector3d p_map = T_map_world * map.centre(voxel.index);
    const double height_m = floor.heightOf(p_map);
    if (height_m < config.min_height_m || height_m > config.max_height_m) return;
    band.push_back({static_cast<int>(std::floor(p_map.x() / config.resolution_m)),
                    static_cast<int>(std::floor(p_map.y() / config.resolution_m)),
                    static_cast<int>(std::floor((height_m - config.min_height_m) / map.resolution())),
                    voxel.state == Occupancy::kOccupied});
  });
  return band;
}

/// One pose that is far off must not make a grid of gigabytes: what lies further from the middle of all than this is
/// left out.
void keepToLargestGrid(std::vector<BandVoxel>& band) {
  constexpr int kMostCells = 10000;  // along a side: 500 m at 5 cm, 100 MB
  for (int BandVoxel::*axis : {&BandVoxel::x, &BandVoxel::y}) {
    const auto less = [axis](const BandVoxel& a, const BandVoxel& b) { return a.*axis < b.*axis; };
    const auto [low, high] = std::minmax_element(band.begin(), band.end(), less);
    if (band.empty() || static_cast<std::int64_t>((*high).*axis) - (*low).*axis < kMostCells) continue;
    const auto middle = band.begin() + static_cast<std::ptrdiff_t>(band.size() / 2);
    std::nth_element(band.begin(), middle, band.end(), less);
    const std::int64_t centre = (*middle).*axis;
    const auto far = [&](const BandVoxel& voxel) { return std::abs(voxel.*axis - centre) >= kMostCells / 2; };
    band.erase(std::remove_if(band.begin(), band.end(), far), band.end());
    logWarning("the map is too large for one grid: what is further than " + std::to_string(kMostCells / 2) +
               " cells from its middle is left out; raise dense.grid.resolution_m");
  }
}

OccupancyGrid emptyGrid(const std::vector<BandVoxel>& band, double resolution_m) {
  OccupancyGrid grid;
  grid.resolution_m = resolution_m;
  if (band.empty()) return grid;
  const auto [min_x, max_x] = std::minmax_element(band.begin(), band.end(), [](auto& a, auto& b) { return a.x < b.x; });
  const auto [min_y, max_y] = std::minmax_element(band.begin(), band.end(), [](auto& a, auto& b) { return a.y < b.y; });
  grid.width = max_x->x - min_x->x + 1;
  grid.height = max_y->y - min_y->y + 1;
  grid.origin_x_m = min_x->x * resolution_m;
  grid.origin_y_m = min_y->y * resolution_m;
  grid.cells.assign(static_cast<std::size_t>(grid.width) * grid.height, OccupancyGrid::kUnknown);
  return grid;
}

}  // namespace

std::optional<Floor> floorOf(const VoxelMap& map, const SE3& T_map_world, const OccupancyGridConfig& config) {
  constexpr double kMostAboveM = 0.15;  // error of a camera's mounting
  std::vector<Eigen::Vector3d> surface;
  map.forEachKnown([&](const Voxel& voxel) {
    if (voxel.state == Occupancy::kOccupied) surface.push_back(T_map_world * map.centre(voxel.index));
  });
  const std::optional<Floor> floor = findFloor(surface, map.resolution());
  if (!floor || floor->offset_m / floor->up.z() > config.floor_height_m + kMostAboveM) return std::nullopt;
  return floor;
}

OccupancyGrid projectToGrid(const VoxelMap& map, const SE3& T_map_world, const OccupancyGridConfig& config) {
  return projectToGrid(map, T_map_world, config, Floor{Eigen::Vector3d::UnitZ(), config.floor_height_m});
}

OccupancyGrid projectToGrid(const VoxelMap& map, const SE3& T_map_world, const OccupancyGridConfig& config,
                            const Floor& floor) {
  validateConfig(config);
  if (config.max_height_m <= config.min_height_m) {
    throw ConfigError("configuration key 'max_height_m' is " + std::to_string(config.max_height_m) +
                      ", must be above min_height_m, which is " + std::to_string(config.min_height_m));
  }
  std::vector<BandVoxel> band = voxelsInBand(map, T_map_world, config, floor);
  keepToLargestGrid(band);
  OccupancyGrid grid = emptyGrid(band, config.resolution_m);
  // Columns of layers, each counted once: several turned voxels can share a layer of a cell.
  std::sort(band.begin(), band.end(), [](const BandVoxel& a, const BandVoxel& b) {
    return std::tie(a.y, a.x, a.layer) < std::tie(b.y, b.x, b.layer);
  });
  const int min_x = static_cast<int>(std::lround(grid.origin_x_m / config.resolution_m));
  const int min_y = static_cast<int>(std::lround(grid.origin_y_m / config.resolution_m));
  const int layers = static_cast<int>(std::floor((config.max_height_m - config.min_height_m) / map.resolution()));
  for (std::size_t i = 0; i < band.size();) {
    const BandVoxel column = band[i];
    bool occupied = false;
    int last_layer = -1, widest_gap = 0;  // in layers
    for (; i < band.size() && band[i].x == column.x && band[i].y == column.y; ++i) {
      occupied = occupied || band[i].occupied;
      widest_gap = std::max(widest_gap, band[i].layer - last_layer - 1);
      last_layer = band[i].layer;
    }
    widest_gap = std::max(widest_gap, layers - last_layer - 1);
    std::int8_t& cell = grid.cells[static_cast<std::size_t>(column.y - min_y) * grid.width + (column.x - min_x)];
    if (occupied) {
      cell = OccupancyGrid::kOccupied;
    } else if (widest_gap * map.resolution() <= config.max_gap_m + 1e-9) {
      cell = OccupancyGrid::kFree;
    }
  }
  return grid;
}

}  // namespace semantic_vslam
