// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "core/dense/up_direction.h"
#include "core/dense/voxel_map.h"
#include "semantic_vslam/core/dense/dense_config.h"
#include "semantic_vslam/core/dense/dense_result.h"

namespace semantic_vslam {

/// The floor that heights are counted from: the one the map shows, if it lies at config.floor_height_m or below it; a
/// plane above that is a table. @return nothing where the map shows none
/// @param T_map_world  into a frame with z roughly up
std::optional<Floor> floorOf(const VoxelMap& map, const SE3& T_map_world, const OccupancyGridConfig& config);

/// Looks down on a height band of a map. A cell is occupied if any voxel of its band is; free if all of the band is
/// known to be free but for gaps up to max_gap_m; else unknown. The grid covers all that is known in the band; it has
/// no cells where nothing is. It is kept in tiles, each of which is made again when a voxel above it changes. Knows no
/// thread.
class GridProjection {
 public:
  /// Takes in what has changed since the last call; always of the same map.
  void update(const VoxelMap& map);
  /// @param T_map_world  into a frame with z up: only the caller knows gravity
  /// @param floor  in that frame
  /// @throws ConfigError
  OccupancyGrid project(const SE3& T_map_world, const OccupancyGridConfig& config, const Floor& floor);

  std::size_t occupied() const { return occupied_; }                 ///< voxels, now
  std::size_t occupiedChanges() const { return occupied_changes_; }  ///< that came or went, in all calls together
  std::size_t memoryBytes() const {
    constexpr std::size_t kBlocksPerTile = 40;  // about
    return blocks_.capacity() * sizeof(Block) + tiles_.size() * (sizeof(Tile) + kBlocksPerTile * sizeof(std::uint32_t));
  }

 private:
  static constexpr int kTileBits = 3, kTileSide = 1 << kTileBits;
  using Bits = std::array<std::uint64_t, kBlockVoxels / 64>;
  /// Smallest and largest cell, along x and y.
  struct Extent {
    int min_x = 0, max_x = -1, min_y = 0, max_y = -1;
    bool empty() const { return max_x < min_x; }
    void add(int x, int y);
  };
  struct Block {
    VoxelKey key = VoxelBlock::kNone;
    bool projected = false;  ///< extent and tiles are those of the bits
    Bits known{}, occupied{};
    Extent extent;  ///< of its voxels in the band
  };
  struct Tile {
    std::vector<std::uint32_t> blocks;  ///< places of those that may have voxels over it
    std::array<std::int8_t, kTileSide * kTileSide> cells{};
    bool stale = true;
  };
  using TileKey = std::pair<int, int>;  ///< y, x
  /// What a projection depends on beside the map.
  struct View {
    Eigen::Matrix4d T_map_world = Eigen::Matrix4d::Zero();
    Eigen::Vector3d up = Eigen::Vector3d::Zero();
    double offset_m = 0.0, cell_m = 0.0, min_m = 0.0, max_m = 0.0, gap_m = 0.0;
    bool operator==(const View& other) const;
  };

  template <class Visit>
  void forEachInBand(const Block& block, const Visit& visit) const;
  template <class Visit>
  void forEachTile(const Extent& extent, const Visit& visit);
  void detach(std::uint32_t place);
  void attach(std::uint32_t place);
  void make(const TileKey& key, Tile& tile) const;
  Extent wholeExtent() const;

  double voxel_m_ = 0.0;
  std::uint32_t revision_ = 0;
  std::vector<Block> blocks_;  ///< at their places in the map
  std::map<TileKey, Tile> tiles_;
  View view_;
  std::size_t occupied_ = 0, occupied_changes_ = 0;
};

}  // namespace semantic_vslam
