// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/dense/keyframe_cloud.h"

/// Packed voxel indices: the one number by which points are sorted into cubes. Private to dense/.
namespace semantic_vslam {

/// Voxels are kept in blocks of 8x8x8, so that neighbours are neighbours in memory.
constexpr int kBlockBits = 3;
constexpr int kBlockSide = 1 << kBlockBits;
constexpr int kBlockVoxels = kBlockSide * kBlockSide * kBlockSide;

/// Index of a voxel from -kVoxelRange to kVoxelRange - 1 an axis: what 63 bits hold (31 km at 3 cm).
constexpr std::int32_t kVoxelRange = 1 << 20;

/// Block index (3 x 18 bits) above the place in the block (9 bits): sorting by it walks block by block.
using VoxelKey = std::uint64_t;

inline bool inVoxelRange(const Eigen::Vector3i& index) {
  return index.minCoeff() >= -kVoxelRange && index.maxCoeff() < kVoxelRange;
}

inline VoxelKey voxelKey(const Eigen::Vector3i& index) {
  VoxelKey block = 0, local = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto shifted = static_cast<VoxelKey>(std::int64_t{index[axis]} + kVoxelRange);
    block = (block << (21 - kBlockBits)) | (shifted >> kBlockBits);
    local = (local << kBlockBits) | (shifted & (kBlockSide - 1));
  }
  return (block << (3 * kBlockBits)) | local;
}

inline Eigen::Vector3i voxelIndex(VoxelKey key) {
  Eigen::Vector3i index;
  VoxelKey local = key, block = key >> (3 * kBlockBits);
  constexpr VoxelKey kBlockMask = (VoxelKey{1} << (21 - kBlockBits)) - 1;
  for (int axis = 2; axis >= 0; --axis) {
    const VoxelKey shifted = ((block & kBlockMask) << kBlockBits) | (local & (kBlockSide - 1));
    index[axis] = static_cast<std::int32_t>(shifted) - kVoxelRange;
    block >>= 21 - kBlockBits;
    local >>= kBlockBits;
  }
  return index;
}

/// Key of the block that a voxel lies in.
inline VoxelKey blockKey(VoxelKey voxel) { return voxel >> (3 * kBlockBits); }

/// Index of a block's lowest voxel.
inline Eigen::Vector3i blockCorner(VoxelKey block) { return voxelIndex(block << (3 * kBlockBits)); }

/// As std::floor, which is a call of the library without SSE 4.
inline int floorToInt(double value) {
  const int truncated = static_cast<int>(value);
  return truncated - (static_cast<double>(truncated) > value ? 1 : 0);
}

inline Eigen::Vector3i voxelIndexAt(const Eigen::Vector3d& point_m, double cell_m) {
  return {floorToInt(point_m.x() / cell_m), floorToInt(point_m.y() / cell_m), floorToInt(point_m.z() / cell_m)};
}

/// A point's place in the vector it came from, with the voxel it falls into.
struct KeyedPoint {
  VoxelKey key;
  std::uint32_t index;
};

/// Sorts points into voxels; within a voxel they keep their order. Points out of range are left out.
/// @param T_grid_points  moves the points into the frame of the grid
inline std::vector<KeyedPoint> sortByVoxel(const std::vector<LabelledPoint>& points, const SE3& T_grid_points,
                                           double cell_m) {
  std::vector<KeyedPoint> keyed;
  keyed.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const cv::Vec3f& p = points[i].xyz_m;
    const Eigen::Vector3i index = voxelIndexAt(T_grid_points * Eigen::Vector3d(p[0], p[1], p[2]), cell_m);
    if (inVoxelRange(index)) keyed.push_back({voxelKey(index), static_cast<std::uint32_t>(i)});
  }
  std::sort(keyed.begin(), keyed.end(), [](const KeyedPoint& a, const KeyedPoint& b) {
    return a.key != b.key ? a.key < b.key : a.index < b.index;
  });
  return keyed;
}

}  // namespace semantic_vslam
