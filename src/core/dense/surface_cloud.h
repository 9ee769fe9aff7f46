// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <unordered_map>
#include <vector>

#include "core/dense/voxel_map.h"

namespace semantic_vslam {

/// The points that one frame gave, and where the map has it.
struct CloudSource {
  std::uint64_t order = 0;  ///< its number among all frames; the same points as before under the same number
  const std::vector<LabelledPoint>* points = nullptr;  ///< in the camera frame
  SE3 T_world_camera = SE3::Identity();                ///< always the same under the same number
};

struct SurfaceCloudConfig {
  double cell_m = 0.01;
  double noise_m_per_m2 = 0.0019;  ///< sigma(z) = noise z^2 of a point
  double max_depth_m = 4.0;        ///< of any point
};

/// One point per cube on the surface of a voxel map, from the points of all frames; kept in parts, each for the space
/// of one block of voxels, until a block beside it changes. Knows no thread.
class SurfaceCloud {
 public:
  /// Takes in what has changed since the last call.
  /// @param map      always the same
  /// @param sources  in ascending order of their numbers
  void update(const VoxelMap& map, const std::vector<CloudSource>& sources, const SurfaceCloudConfig& config);

  /// Mean position and colour in each cube, label by the votes of all keyframes. World frame, in a fixed order.
  std::vector<LabelledPoint> points() const;
  std::size_t size() const;
  /// Calls back for all parts of it, in that order.
  void forEachPart(const std::function<void(const std::vector<LabelledPoint>&)>& visit) const;
  std::size_t memoryBytes() const { return bytes_ + blocks_.capacity() * sizeof(VoxelBlock); }

 private:
  /// A frame's points by the block that they lie in, before they are moved onto the surface.
  struct Indexed {
    std::size_t points = 0;               ///< of the source when this was made
    std::vector<std::uint32_t> by_block;  ///< places of the points, sorted by block
    std::vector<VoxelKey> blocks;
    std::size_t bytes() const;
  };
  struct Run {
    std::uint64_t order;
    std::uint32_t begin, end;  ///< in Indexed::by_block
  };
  using Keys = std::vector<VoxelKey>;  ///< of blocks, sorted, each once

  Keys takeChanges(const VoxelMap& map);
  void takeSources(const VoxelMap& map, const std::vector<CloudSource>& sources, Keys& changed);
  void index(const CloudSource& source, double voxel_m);
  void forget(std::map<std::uint64_t, Indexed>::iterator source);
  void make(const Keys& parts, const Keys& near, const VoxelMap& map, const std::vector<CloudSource>& sources,
            const SurfaceCloudConfig& config);
  void set(VoxelKey part, std::vector<LabelledPoint> points);

  std::uint32_t revision_ = 0;
  std::vector<VoxelBlock> blocks_;  ///< as they were at the last update
  std::map<std::uint64_t, Indexed> sources_;
  std::unordered_map<VoxelKey, std::vector<Run>> runs_;  ///< by block
  std::map<VoxelKey, std::vector<LabelledPoint>> parts_;
  std::size_t bytes_ = 0;
};

}  // namespace semantic_vslam
