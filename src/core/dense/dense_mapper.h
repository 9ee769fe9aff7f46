// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/dense/dense_map_file.h"
#include "core/dense/map_objects.h"
#include "core/dense/occupancy_grid.h"
#include "core/dense/octomap_export.h"
#include "core/dense/surface_cloud.h"
#include "core/dense/voxel_map.h"
#include "semantic_vslam/core/dense/dense_config.h"
#include "semantic_vslam/core/geometry/timed_pose.h"

namespace semantic_vslam {

/// The dense map: keyframes in, labelled cloud, OctoMap and navigation grid out. Each keyframe's static surface is kept
/// in its own camera frame. When optimisation or a loop moves poses, the map is built again from them, a few keyframes
/// a call, while the old one is still served.
///
/// Memory: of the keyframes that the sparse map dropped, the newest are held, two for each that it has: the older ones
/// are forgotten. Their points leave the cloud at once, the voxels that only they saw at the next rebuild. Those are
/// few, since the sparse map drops a keyframe when three others see most of what it sees. So memory grows with the
/// space seen, not with time. memory_mb bounds all of it: kept keyframes, voxels, twice, since a rebuild makes them
/// anew beside the old ones, and what is kept for who is served. Above it, with one warning: looks are forgotten, old
/// clouds are thinned to half a voxel (the cloud gets coarser, the voxels keep all they had), dropped keyframes are
/// forgotten, and then, while keyframes hold more than a third, those farthest from the newest: their points leave the
/// cloud; what they saw last stays in the voxels, but follows no loop any more. If that is not enough, the voxels
/// farthest from the newest keyframe go.
///
/// Knows no thread: the caller serialises all calls. Const, and dear only the first time: cloud, grid and octree.
class DenseMapper {
 public:
  /// @throws ConfigError
  DenseMapper(const DenseConfig& config, const LabelSet& labels);

  /// Adds a keyframe; during a rebuild it is seen at once, where it lies among the old poses. Also does one slice of a
  /// rebuild.
  /// @param labels   indices into the label set, of the frame's size, or empty
  /// @param dynamic  MotionResult::dynamic, of the frame's size, or empty
  /// @return false, with nothing changed, if the images differ in size, the pose is not finite or the id is known.
  bool add(KeyframeId id, const RgbdFrame& frame, const cv::Mat1b& labels, const cv::Mat1b& dynamic,
           const SE3& T_world_camera);

  /// Looks at a frame between keyframes: it takes away and adds as a keyframe does, but of all that lie beside one
  /// keyframe only the newest kLooks are kept, so that a camera that stands makes the map no larger. The others' mark
  /// on the voxels lasts until the next rebuild.
  /// @param beside  keyframe that it moves with, or the one nearest in time that is held
  /// @return false, with nothing changed, for what add() refuses and where no keyframe is held.
  bool look(KeyframeId beside, const RgbdFrame& frame, const cv::Mat1b& labels, const cv::Mat1b& dynamic,
            const SE3& T_world_camera);
  static constexpr std::size_t kLooks = 3;  ///< as many as take away what is gone

  /// Takes the poses of all keyframes as they stand. One that is held here but is not among them was culled: it moves
  /// with the one nearest in time that is left. Starts a rebuild if any pose moved far enough, and does one slice of
  /// it.
  void updatePoses(const std::vector<KeyframePose>& poses);

  /// A rebuild is under way: what is served has old poses.
  bool busy() const { return next_.has_value(); }
  /// Does one slice of a rebuild; nothing when not busy.
  void work();
  /// Does all of it. Call before saving.
  void finish();

  /// One point per cube of cloud_resolution_m on an occupied voxel: mean position and colour, label by the votes of all
  /// keyframes. World frame, in a fixed order.
  std::vector<LabelledPoint> cloud() const { return surfaceCloud().points(); }
  /// The same in parts, with what changed since the last call made anew.
  const SurfaceCloud& surfaceCloud() const;
  /// What the map knows of a point on its surface: for findObjects().
  SurfaceEvidence evidenceAt(const Eigen::Vector3d& point_world) const;
  /// Heights are counted from the floor that the map shows, see floorOf(); it is looked for again when a tenth of the
  /// surface has changed. What it finds is said once in the log.
  /// @param T_map_world  into a frame with z up
  OccupancyGrid projectedMap(const SE3& T_map_world) const;
  const OctreeStream& octree() const;
  OctreeMessage binaryOctree() const { return semantic_vslam::binaryOctree(octree()); }
  OctreeMessage fullOctree() const { return semantic_vslam::fullOctree(octree()); }

  /// Each writes the file whole or not at all. @throws FileError naming path and cause.
  void saveCloud(const std::string& path) const;
  void saveOctomap(const std::string& path) const;
  void saveMesh(const std::string& path) const;
  /// cloud.pcd, mesh.ply, map.ot, map.bt and, where the grid has cells, grid.pgm and grid.yaml, of a world whose z is
  /// up.
  /// @throws FileError naming path and cause
  void saveForOthers(const std::string& folder) const;

  void clear();
  /// Forgets what the keyframes so far saw in a box of the world, metres; builds the map anew.
  void clearBox(const Eigen::AlignedBox3d& box_m);

  /// All keyframes as they stand, to be saved. @param map_id  goes along
  DenseMapContent content(std::uint32_t map_id) const;
  /// Takes saved keyframes in the place of the present ones and builds the map from them.
  void restore(std::vector<DenseKeyframe> keyframes);

  /// Forgets the parts that clouds, octrees and grids are put together from, and the floor: the next ones are made
  /// anew.
  void forgetParts() const;

  const VoxelMap& voxelMap() const { return served_.voxels; }
  const LabelSet& labels() const { return labels_; }
  std::size_t voxels() const { return served_.voxels.size(); }  ///< known, in the served map
  std::size_t keyframes() const { return keyframes_.size(); }   ///< held
  /// Of the keyframes that the served map was built from, as it was.
  std::vector<KeyframePose> poses() const;
  /// Of all frames that the served map holds: keyframes and the looks beside them.
  std::vector<TimedPose> views() const;
  std::size_t forgotten() const { return forgotten_; }  ///< keyframes that are held no more
  std::size_t rebuilds() const { return rebuilds_; }    ///< completed
  /// Of the kept clouds, the voxel maps and what is kept for who is served.
  std::size_t memoryBytes() const;

 private:
  struct Integrated {
    Stamp stamp;
    KeyframeId keyframe;  ///< it, or the one that a look lies beside
  };
  /// The floor that heights are counted from until a tenth of the surface has changed.
  struct HeldFloor {
    SE3 T_map_world;
    std::size_t occupied_changes = 0;  ///< GridProjection's when it was looked for
    std::optional<Floor> floor;
  };
  /// A map with the poses it was built from.
  struct Version {
    VoxelMap voxels;
    std::map<KeyframeId, SE3> T_world_camera;
    std::vector<Integrated> frames;  ///< in the order in which they were integrated
    // What was made of it for who is served, part by part: only what changed since is made again.
    mutable OctreeStream octree;
    mutable SurfaceCloud cloud;
    mutable GridProjection grid;
    mutable std::optional<HeldFloor> floor;
    std::size_t partsBytes() const { return octree.memoryBytes() + cloud.memoryBytes() + grid.memoryBytes(); }
  };
  /// A keyframe or a look that a rebuild has still to take in.
  struct Due {
    std::uint64_t order;
    KeyframeId keyframe;
  };

  Version emptyVersion() const;
  bool usable(const RgbdFrame& frame, const cv::Mat1b& labels, const cv::Mat1b& dynamic, const SE3& T_world_camera);
  bool inReach(const SE3& T_world_camera);
  void integrate(const DenseKeyframe& keyframe, const SE3& T_world_camera, Version& version) const;
  void integrate(const DenseLook& look, Version& version) const;
  std::optional<Floor> floor(const SE3& T_map_world) const;
  /// @param forgotten_m  where nothing stays of keyframes that are held no more
  void startRebuild(const Eigen::AlignedBox3d& forgotten_m = {});
  void carryOver(const Eigen::AlignedBox3d& forgotten_m);
  /// Where a keyframe lies among other poses than the newest: as it lies to the one of them that is nearest in time.
  SE3 poseAmong(const std::map<KeyframeId, SE3>& T_world_camera, KeyframeId id) const;
  bool stale() const;
  void forgetOldCulled();
  void keepToBudget();
  std::size_t budgetBytes() const { return static_cast<std::size_t>(config_.memory_mb) << 20; }
  std::size_t neededBytes() const;
  void letGoFarKeyframes();
  void keepVoxelsToBudget(Version& version) const;
  std::map<KeyframeId, DenseKeyframe>::iterator forget(std::map<KeyframeId, DenseKeyframe>::iterator keyframe);

  DenseConfig config_;
  LabelSet labels_;
  std::map<KeyframeId, DenseKeyframe> keyframes_;
  std::size_t kept_bytes_ = 0;
  enum class FloorTold { kNothing, kMissing, kFound };
  mutable FloorTold floor_told_ = FloorTold::kNothing;  ///< what the log has; changes nothing that is served
  bool warned_ = false;                                 ///< that memory_mb is used up
  std::set<KeyframeId> let_go_;                         ///< for want of memory; what they saw last stays in the voxels
  bool warned_of_reach_ = false;                        ///< that a pose is out of reach
  Version served_;
  std::optional<Version> next_;
  std::deque<Due> due_;  ///< for next_, in their order
  std::uint64_t next_order_ = 0;
  std::size_t forgotten_ = 0, rebuilds_ = 0;
};

}  // namespace semantic_vslam
