// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "semantic_vslam/core/dense/dense_result.h"

namespace semantic_vslam {

/// Writes a grid as map_server takes it: NAME.pgm (occupied 0, free 254, unknown 205; its first row is the one farthest
/// along y) and NAME.yaml, which names it. Each whole or not at all.
/// @param name  path without an ending  @throws Error if the grid has no cells  @throws FileError naming path and cause
void writeGrid(const OccupancyGrid& grid, const std::string& name);

}  // namespace semantic_vslam
