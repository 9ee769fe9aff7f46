// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/dense/voxel_map.h"
#include "semantic_vslam/core/common/label_set.h"

namespace semantic_vslam {

/// The fused surface as triangles, in the frame of the map.
struct SurfaceMesh {
  std::vector<LabelledPoint> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise as seen from free space
};

/// Surface nets (Gibson 1998) over the fused distances: a vertex in each cube of eight voxels' centres that the surface
/// passes through beside an occupied voxel, in the middle of where it crosses the cube's edges.
SurfaceMesh makeSurfaceMesh(const VoxelMap& map);

/// Writes a binary PLY file with x y z (float, metres), red green blue and label (uchar); comments name the labels.
/// Whole or not at all. @throws FileError naming path and cause.
void writePly(const SurfaceMesh& mesh, const LabelSet& labels, const std::string& path);

}  // namespace semantic_vslam
