// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
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

/// Looks down on a height band of the map. A cell is occupied if any voxel of its band is; free if all of the band is
/// known to be free but for gaps up to max_gap_m; else unknown. The grid covers all that is known in the band; it has
/// no cells where nothing is.
/// @param T_map_world  into a frame with z up: only the caller knows gravity
/// @param floor  in that frame
/// @throws ConfigError
OccupancyGrid projectToGrid(const VoxelMap& map, const SE3& T_map_world, const OccupancyGridConfig& config,
                            const Floor& floor);
/// The same above a level floor at config.floor_height_m.
OccupancyGrid projectToGrid(const VoxelMap& map, const SE3& T_map_world, const OccupancyGridConfig& config);

}  // namespace semantic_vslam
