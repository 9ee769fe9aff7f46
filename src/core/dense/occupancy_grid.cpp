// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/dense/occupancy_grid.h"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <limits>
#include <string>

#include "semantic_vslam/core/common/config_fields.h"
#include "semantic_vslam/core/common/error.h"
#include "semantic_vslam/core/common/log.h"

namespace semantic_vslam {

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

void GridProjection::Extent::add(int x, int y) {
  if (empty()) {
    min_x = max_x = x;
    min_y = max_y = y;
    return;
  }
  min_x = std::min(min_x, x);
  max_x = std::max(max_x, x);
  min_y = std::min(min_y, y);
  max_y = std::max(max_y, y);
}

bool GridProjection::View::operator==(const View& other) const {
  return T_map_world == other.T_map_world && up == other.up && offset_m == other.offset_m && cell_m == other.cell_m &&
         min_m == other.min_m && max_m == other.max_m && gap_m == other.gap_m;
}

/// Calls back with the cell, the layer (voxels upwards from the lower edge) and whether it is occupied.
template <class Visit>
void GridProjection::forEachInBand(const Block& block, const Visit& visit) const {
  const Eigen::Matrix3d R = view_.T_map_world.topLeftCorner<3, 3>();
  const Eigen::Vector3d t = view_.T_map_world.topRightCorner<3, 1>();
  const Eigen::Vector3i corner = blockCorner(block.key);
  for (int local = 0; local < kBlockVoxels; ++local) {
    if ((block.known[local >> 6] >> (local & 63) & 1) == 0) continue;
    const Eigen::Vector3i index =
        corner +
        Eigen::Vector3i(local >> (2 * kBlockBits), local >> kBlockBits & (kBlockSide - 1), local & (kBlockSide - 1));
    const Eigen::Vector3d p_map = R * ((index.cast<double>().array() + 0.5) * voxel_m_).matrix() + t;
    const double height_m = view_.up.dot(p_map) - view_.offset_m;
    if (height_m < view_.min_m || height_m > view_.max_m) continue;
    visit(static_cast<int>(std::floor(p_map.x() / view_.cell_m)),
          static_cast<int>(std::floor(p_map.y() / view_.cell_m)),
          static_cast<int>(std::floor((height_m - view_.min_m) / voxel_m_)),
          (block.occupied[local >> 6] >> (local & 63) & 1) != 0);
  }
}

template <class Visit>
void GridProjection::forEachTile(const Extent& extent, const Visit& visit) {
  if (extent.empty()) return;
  for (int y = extent.min_y >> kTileBits; y <= extent.max_y >> kTileBits; ++y) {
    for (int x = extent.min_x >> kTileBits; x <= extent.max_x >> kTileBits; ++x) visit(TileKey(y, x));
  }
}

void GridProjection::detach(std::uint32_t place) {
  Block& block = blocks_[place];
  if (!block.projected) return;
  forEachTile(block.extent, [&](const TileKey& key) {
    const auto tile = tiles_.find(key);
    std::vector<std::uint32_t>& over = tile->second.blocks;
    over.erase(std::remove(over.begin(), over.end(), place), over.end());
    tile->second.stale = true;
    if (over.empty()) tiles_.erase(tile);
  });
  block.projected = false;
}

void GridProjection::attach(std::uint32_t place) {
  Block& block = blocks_[place];
  block.extent = Extent();
  block.projected = true;
  if (block.key == VoxelBlock::kNone) return;
  forEachInBand(block, [&](int x, int y, int, bool) { block.extent.add(x, y); });
  forEachTile(block.extent, [&](const TileKey& key) {
    Tile& tile = tiles_[key];
    tile.blocks.push_back(place);
    tile.stale = true;
  });
}

void GridProjection::update(const VoxelMap& map) {
  voxel_m_ = map.resolution();
  const std::vector<VoxelBlock>& blocks = map.blocks();
  blocks_.resize(blocks.size());
  for (std::uint32_t place = 0; place < blocks.size(); ++place) {
    Block& block = blocks_[place];
    if (block.key == blocks[place].key && blocks[place].changed <= revision_) continue;
    Bits known{}, occupied{};
    if (blocks[place].key != VoxelBlock::kNone) {
      map.forEachKnownIn(blocks[place].key, [&](const Voxel& voxel) {
        const auto local = static_cast<unsigned>(voxelKey(voxel.index) & (kBlockVoxels - 1));
        known[local >> 6] |= std::uint64_t{1} << (local & 63);
        if (voxel.state == Occupancy::kOccupied) occupied[local >> 6] |= std::uint64_t{1} << (local & 63);
      });
    }
    if (block.key == blocks[place].key && known == block.known && occupied == block.occupied) continue;
    detach(place);
    for (std::size_t i = 0; i < occupied.size(); ++i) {
      occupied_changes_ += std::bitset<64>(occupied[i] ^ block.occupied[i]).count();
      occupied_ += std::bitset<64>(occupied[i]).count();
      occupied_ -= std::bitset<64>(block.occupied[i]).count();
    }
    block.key = blocks[place].key;
    block.known = known;
    block.occupied = occupied;
  }
  revision_ = map.revision();
}

/// A column is free if no gap in what is known of it is too wide.
void GridProjection::make(const TileKey& key, Tile& tile) const {
  const int layers = static_cast<int>(std::floor((view_.max_m - view_.min_m) / voxel_m_));
  struct Column {
    std::vector<bool> known;
    bool any = false, occupied = false;
  };
  std::array<Column, kTileSide * kTileSide> columns;
  for (const std::uint32_t place : tile.blocks) {
    forEachInBand(blocks_[place], [&](int x, int y, int layer, bool occupied) {
      if (x >> kTileBits != key.second || y >> kTileBits != key.first) return;
      Column& column = columns[static_cast<std::size_t>((y & (kTileSide - 1)) * kTileSide + (x & (kTileSide - 1)))];
      if (!column.any) column.known.assign(static_cast<std::size_t>(layers) + 1, false);
      column.any = true;
      column.occupied = column.occupied || occupied;
      column.known[static_cast<std::size_t>(layer)] = true;  // several turned voxels can share a layer of a cell
    });
  }
  for (std::size_t i = 0; i < columns.size(); ++i) {
    tile.cells[i] = OccupancyGrid::kUnknown;
    if (!columns[i].any) continue;
    if (columns[i].occupied) {
      tile.cells[i] = OccupancyGrid::kOccupied;
      continue;
    }
    int last_layer = -1, widest_gap = 0;  // in layers
    for (int layer = 0; layer <= layers; ++layer) {
      if (!columns[i].known[static_cast<std::size_t>(layer)]) continue;
      widest_gap = std::max(widest_gap, layer - last_layer - 1);
      last_layer = layer;
    }
    widest_gap = std::max(widest_gap, layers - last_layer - 1);
    if (widest_gap * voxel_m_ <= view_.gap_m + 1e-9) tile.cells[i] = OccupancyGrid::kFree;
  }
  tile.stale = false;
}

/// One pose that is far off must not make a grid of gigabytes: what lies further from the middle of all than this is
/// left out.
GridProjection::Extent GridProjection::wholeExtent() const {
  constexpr int kMostCells = 10000;  // along a side: 500 m at 5 cm, 100 MB
  Extent limit, whole;
  limit.min_x = limit.min_y = std::numeric_limits<int>::min();
  limit.max_x = limit.max_y = std::numeric_limits<int>::max();
  const auto sides = {std::make_pair(&Extent::min_x, &Extent::max_x), std::make_pair(&Extent::min_y, &Extent::max_y)};
  for (const auto& [low, high] : sides) {
    std::vector<int> middles;
    std::int64_t least = std::numeric_limits<int>::max(), most = std::numeric_limits<int>::min();
    for (const Block& block : blocks_) {
      if (block.extent.empty()) continue;
      middles.push_back(block.extent.*low);
      least = std::min<std::int64_t>(least, block.extent.*low);
      most = std::max<std::int64_t>(most, block.extent.*high);
    }
    if (middles.empty() || most - least < kMostCells) continue;
    const auto middle = middles.begin() + static_cast<std::ptrdiff_t>(middles.size() / 2);
    std::nth_element(middles.begin(), middle, middles.end());
    limit.*low = *middle - kMostCells / 2;
    limit.*high = *middle + kMostCells / 2;
    logWarning("the map is too large for one grid: what is further than " + std::to_string(kMostCells / 2) +
               " cells from its middle is left out; raise dense.grid.resolution_m");
  }
  for (const Block& block : blocks_) {
    const Extent& own = block.extent;
    if (own.empty() || own.min_x < limit.min_x || own.max_x > limit.max_x || own.min_y < limit.min_y ||
        own.max_y > limit.max_y) {
      continue;
    }
    whole.add(own.min_x, own.min_y);
    whole.add(own.max_x, own.max_y);
  }
  return whole;
}

OccupancyGrid GridProjection::project(const SE3& T_map_world, const OccupancyGridConfig& config, const Floor& floor) {
  validateConfig(config);
  if (config.max_height_m <= config.min_height_m) {
    throw ConfigError("configuration key 'max_height_m' is " + std::to_string(config.max_height_m) +
                      ", must be above min_height_m, which is " + std::to_string(config.min_height_m));
  }
  const View view{T_map_world.matrix(), floor.up,        floor.offset_m, config.resolution_m, config.min_height_m,
                  config.max_height_m,  config.max_gap_m};
  if (!(view == view_)) {
    view_ = view;
    tiles_.clear();
    for (Block& block : blocks_) block.projected = false;
  }
  for (std::uint32_t place = 0; place < blocks_.size(); ++place) {
    if (!blocks_[place].projected) attach(place);
  }
  OccupancyGrid grid;
  grid.resolution_m = config.resolution_m;
  const Extent whole = wholeExtent();
  if (whole.empty()) return grid;
  grid.width = whole.max_x - whole.min_x + 1;
  grid.height = whole.max_y - whole.min_y + 1;
  grid.origin_x_m = whole.min_x * config.resolution_m;
  grid.origin_y_m = whole.min_y * config.resolution_m;
  grid.cells.assign(static_cast<std::size_t>(grid.width) * grid.height, OccupancyGrid::kUnknown);
  for (auto& [key, tile] : tiles_) {
    if (tile.stale) make(key, tile);
    for (int i = 0; i < kTileSide * kTileSide; ++i) {
      const int x = key.second * kTileSide + i % kTileSide - whole.min_x;
      const int y = key.first * kTileSide + i / kTileSide - whole.min_y;
      if (x < 0 || y < 0 || x >= grid.width || y >= grid.height) continue;
      grid.cells[static_cast<std::size_t>(y) * grid.width + x] = tile.cells[static_cast<std::size_t>(i)];
    }
  }
  return grid;
}

}  // namespace semantic_vslam
