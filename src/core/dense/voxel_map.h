// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "core/dense/free_space.h"
#include "core/dense/keyframe_cloud.h"
#include "core/dense/voxel_key.h"
#include "semantic_vslam/core/dense/dense_config.h"

namespace semantic_vslam {

enum class Occupancy { kUnknown, kFree, kOccupied };

/// What the map knows of one voxel.
struct Voxel {
  Eigen::Vector3i index;  ///< voxel i spans [i, i + 1) x resolution in the world
  Occupancy state = Occupancy::kUnknown;
  double log_odds = 0.0;  ///< of being occupied
  cv::Vec3b bgr;          ///< mean colour of the points in it; black where none
  std::uint8_t label = 0;
  double label_share = 0.0;    ///< of the votes for a label
  std::uint32_t last_hit = 0;  ///< number of the keyframe that hit it last, counted from 1; 0 = none
  int hits = 0;                ///< keyframes with a point in it
  int misses = 0;              ///< keyframes that looked through it after the first point
};

/// A cube of 8x8x8 voxels, as the map keeps them: what changed is told by them.
struct VoxelBlock {
  static constexpr VoxelKey kNone = ~VoxelKey{0};
  VoxelKey key = kNone;               ///< see blockKey(); kNone: the place is empty
  std::uint32_t changed = 0;          ///< VoxelMap::revision() when a voxel in it was last served otherwise than before
  std::uint32_t surface_changed = 0;  ///< the same of voxels that hold points and of distances; 0 = there are none
};

/// Occupancy, colour and label of space, fused over keyframes (occupancy: Hornung et al. 2013, eq. 2-4).
///
/// The voxels that OctoMap keeps in an octree lie here in hashed blocks of 8x8x8 (Niessner et al. 2013), and free space
/// is found by projecting voxels into the depth image instead of walking along rays: every voxel is then updated once
/// a keyframe, none is skipped between two rays, and a surface seen at a flat angle is not eaten away by the rays
/// beside it. A keyframe of a desk takes 9 ms instead of the 45 ms of OctoMap's discretised, lazy insertion at the same
/// 3 cm. The map leaves as an OctoMap (octomap_export.h).
///
/// Where a surface is within its voxels, a running mean of signed distances tells, weighted by the range it was seen
/// from (Curless and Levoy 1996): many keyframes' noisy points become one surface, and voxels that only noise hit are
/// neither free nor occupied.
///
/// What is gone leaves: a voxel that three keyframes in a row looked through is free, however often it was hit before.
/// What one keyframe alone saw is doubted when others that should see it do not, and unless it goes on from what was
/// seen again, it goes when ten had its place in view: the part of a person that no mask found.
///
/// A voxel that half as many keyframes took for a person or a moving thing as had a point in it is not shown until one
/// looks through it: masks miss people now and then.
///
/// Memory: 1 kB a block (1.1 MB for 15 m^3 at 3 cm), 2 kB more near surfaces, and about 30 bytes for each voxel that
/// holds a surface.
class VoxelMap {
 public:
  /// @throws ConfigError
  explicit VoxelMap(const VoxelMapConfig& config);
  ~VoxelMap();
  VoxelMap(VoxelMap&&) noexcept;
  VoxelMap& operator=(VoxelMap&&) noexcept;

  /// Adds one keyframe. A voxel that holds one of its points is hit, whatever the view says; else it is missed if it
  /// lies wholly before what the view saw.
  /// @param points  in the camera frame, metres
  void integrate(const std::vector<LabelledPoint>& points, const FreeSpaceView& view, const SE3& T_world_camera);

  /// @return the voxel with this index; state kUnknown and zeros where nothing is known.
  Voxel voxel(const Eigen::Vector3i& index) const;
  /// @param point_world  metres
  Voxel voxelAt(const Eigen::Vector3d& point_world) const;
  /// Calls back for every voxel that is free or occupied, in a fixed order.
  void forEachKnown(const std::function<void(const Voxel&)>& visit) const;

  /// Calls back for those of one block, in a fixed order. @param block  key of one that is there
  void forEachKnownIn(VoxelKey block, const std::function<void(const Voxel&)>& visit) const;

  /// All blocks. One stays at its place in the vector as long as it is there, so that what is made of it can be kept
  /// beside it until it changes.
  const std::vector<VoxelBlock>& blocks() const;
  /// Keyframes taken in so far, those taken over from another map among them.
  std::uint32_t revision() const;

  /// Fused signed distance of a voxel's centre to the surface, metres, above 0 before it; nothing where none is known.
  std::optional<float> distance(const Eigen::Vector3i& index) const;

  /// Reads the surface round many points; those near each other cost little. The map must not change meanwhile.
  class SurfaceReader {
   public:
    explicit SurfaceReader(const VoxelMap& map);
    ~SurfaceReader();
    /// Moves a point onto the fused surface, along its normal. One where the surface is not known all round stays.
    /// @param point  world, metres
    /// @return false if it lies farther than most_m from the surface; no point is moved farther than kMost most_m
    bool moveOntoSurface(LabelledPoint& point, double most_m);
    static constexpr double kMost = 1.25;
    /// Label of the occupied voxel at a point; nothing where none is.
    std::optional<std::uint8_t> labelAt(const Eigen::Vector3d& point_world);

   private:
    struct Inside;
    std::unique_ptr<Inside> inside_;
  };

  /// Forgets the blocks that lie farthest from a place until memoryBytes() is at most this.
  void forgetFarthest(const Eigen::Vector3d& place_m, std::size_t most_bytes);
  /// Takes over blocks of another map of the same configuration. Only into an empty map.
  /// @param renumber  gives what number a keyframe of the other map (counted from 1) has here, from 1 on
  void takeOver(const VoxelMap& other, const std::function<bool(const VoxelBlock&)>& wanted,
                const std::function<std::uint32_t(std::uint32_t)>& renumber);

  double resolution() const;
  Eigen::Vector3d centre(const Eigen::Vector3i& index) const;
  /// @return voxels ever hit or missed.
  std::size_t size() const;
  std::size_t memoryBytes() const;  ///< counted as it grows: costs nothing

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace semantic_vslam
