// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "core/dense/voxel_map.h"
#include "semantic_vslam/core/dense/dense_config.h"
#include "semantic_vslam/core/dense/dense_result.h"

namespace semantic_vslam {

/// Looks down on a height band of the map. A cell is occupied if any voxel of its band is; free if enough of it is
/// known to be free; else unknown. The grid covers all that is known in the band; it has no cells where nothing is.
/// @param T_map_world  into a frame with z up: only the caller knows gravity
/// @throws ConfigError
OccupancyGrid projectToGrid(const VoxelMap& map, const SE3& T_map_world, const OccupancyGridConfig& config);

}  // namespace semantic_vslam
