// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/dense/dense_mapper.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <string>
#include <utility>

#include "core/dense/cloud_file.h"
#include "core/dense/grid_file.h"
#include "semantic_vslam/core/common/config_fields.h"
#include "semantic_vslam/core/common/log.h"

namespace semantic_vslam {
namespace {

// A tree of OctoMap has this many cells on each side of its origin.
constexpr double kOctomapCells = 32768;
constexpr double kFarthestPointM = 20.0;  // from a camera
// Three keyframes in a row free a voxel: with two that were culled for each that was not, a place has about three views
// of late. A first visit of a place stays below this.
constexpr std::size_t kCulledPerHeld = 2;

const DenseConfig& validated(const DenseConfig& config) {
  validateConfig(config);
  return config;
}

bool fits(const RgbdFrame& frame, const cv::Mat1b& image) {
  return image.empty() || image.size() == frame.depth_m.size();
}

std::size_t bytesOf(const KeyframeCloud& cloud, const FreeSpaceView& view) {
  return cloud.points.capacity() * sizeof(LabelledPoint) + view.bytes();
}

cv::Vec3f transform(const SE3& T, const cv::Vec3f& p) {
  const Eigen::Vector3f q = (T * Eigen::Vector3d(p[0], p[1], p[2])).cast<float>();
  return {q.x(), q.y(), q.z()};
}

/// The keyframe nearest in time: ids are given in that order. Not the nearest in space, which may be of another visit
/// of the place, with other drift.
/// @param T_world_camera  not empty
std::map<KeyframeId, SE3>::const_iterator nearestInTime(const std::map<KeyframeId, SE3>& T_world_camera,
                                                        KeyframeId id) {
  const auto after = T_world_camera.lower_bound(id);
  if (after == T_world_camera.begin()) return after;
  const auto before = std::prev(after);
  if (after == T_world_camera.end()) return before;
  return after->first.value() - id.value() < id.value() - before->first.value() ? after : before;
}

}  // namespace

DenseMapper::DenseMapper(const DenseConfig& config, const LabelSet& labels)
    : config_(validated(config)), labels_(labels), served_{VoxelMap(config.voxels), {}} {}

bool DenseMapper::add(KeyframeId id, const RgbdFrame& frame, const cv::Mat1b& labels, const cv::Mat1b& dynamic,
                      const SE3& T_world_camera) {
  const bool usable = frame.camera != nullptr && !frame.depth_m.empty() && fits(frame, labels) && fits(frame, dynamic);
  if (!usable || !inReach(T_world_camera) || keyframes_.count(id) > 0) return false;
  const cv::Mat1b excluded = excludedPixels(frame.depth_m, labels, dynamic, labels_, config_.keyframe);
  DenseKeyframe kept;
  kept.cloud = makeKeyframeCloud(id, frame, labels, excluded, config_.keyframe);
  kept.cloud.points = voxelFilter(kept.cloud.points, config_.cloud_resolution_m);
  kept.view = makeFreeSpaceView(frame, excluded, config_.keyframe);
  kept.T_world_camera = T_world_camera;
  kept_bytes_ += bytesOf(kept.cloud, kept.view);
  keyframes_.emplace(id, std::move(kept));
  // What is served stays of one piece during a rebuild: the keyframe goes where it lies among the old poses.
  integrate(id, busy() ? poseAmong(served_.T_world_camera, id) : T_world_camera, served_);
  keepToBudget();  // only now: what is served has every keyframe in full
  work();
  return true;
}

bool DenseMapper::inReach(const SE3& T_world_camera) {
  const double reach_m = kOctomapCells * config_.voxels.resolution_m - kFarthestPointM;
  if (T_world_camera.matrix().allFinite() && T_world_camera.translation().cwiseAbs().maxCoeff() <= reach_m) return true;
  if (!std::exchange(warned_of_reach_, true)) {
    logWarning("a keyframe lies further than " + std::to_string(static_cast<int>(reach_m)) +
               " m from the map's origin: it and what else is out of OctoMap's reach is left out of the dense map; "
               "raise dense.voxels.resolution_m, or begin nearer to the origin");
  }
  return false;
}

void DenseMapper::integrate(KeyframeId id, const SE3& T_world_camera, Version& version) const {
  const DenseKeyframe& kept = keyframes_.at(id);
  version.voxels.integrate(kept.cloud.points, kept.view, T_world_camera);
  version.T_world_camera[id] = T_world_camera;
}

SE3 DenseMapper::poseAmong(const std::map<KeyframeId, SE3>& T_world_camera, KeyframeId id) const {
  const SE3& own = keyframes_.at(id).T_world_camera;
  if (T_world_camera.empty()) return own;
  const auto neighbour = nearestInTime(T_world_camera, id);
  return neighbour->second * keyframes_.at(neighbour->first).T_world_camera.inverse() * own;
}

void DenseMapper::updatePoses(const std::vector<KeyframePose>& poses) {
  std::map<KeyframeId, SE3> optimised;
  for (const KeyframePose& pose : poses) {
    if (keyframes_.count(pose.keyframe) > 0 && inReach(pose.T_world_camera)) {
      optimised[pose.keyframe] = pose.T_world_camera;
    }
  }
  if (optimised.empty()) return;
  for (auto& [id, kept] : keyframes_) {  // before the others change
    // A keyframe newer than all of them is not listed yet.
    kept.culled = optimised.count(id) == 0 && id < optimised.rbegin()->first;
    if (optimised.count(id) == 0) kept.T_world_camera = poseAmong(optimised, id);
  }
  for (const auto& [id, T_world_camera] : optimised) keyframes_.at(id).T_world_camera = T_world_camera;
  forgetOldCulled();
  if (!busy() && stale()) next_.emplace(Version{VoxelMap(config_.voxels), {}});
  work();
}

bool DenseMapper::stale() const {
  const double limit_rad = config_.reanchor_rotation_deg * CV_PI / 180.0;
  return std::any_of(keyframes_.begin(), keyframes_.end(), [&](const auto& item) {
    const auto built = served_.T_world_camera.find(item.first);
    if (built == served_.T_world_camera.end()) return true;
    const SE3 moved = built->second.inverse() * item.second.T_world_camera;
    return moved.translation().norm() > config_.reanchor_translation_m || rotationAngle(moved) > limit_rad;
  });
}

void DenseMapper::work() {
  if (!busy()) return;
  int budget = config_.rebuild_keyframes_per_call;
  for (const auto& [id, kept] : keyframes_) {
    if (next_->T_world_camera.count(id) > 0) continue;
    if (budget-- == 0) return;
    integrate(id, kept.T_world_camera, *next_);
  }
  served_ = std::move(*next_);
  next_.reset();
  ++rebuilds_;
  // Poses that moved during the rebuild: once more, later. Never start over before one is complete.
  if (stale()) next_.emplace(Version{VoxelMap(config_.voxels), {}});
}

void DenseMapper::finish() {
  while (busy()) work();
}

void DenseMapper::keepToBudget() {
  const auto budget_bytes = static_cast<std::size_t>(config_.memory_mb) << 20;
  // Points half a voxel apart hit every voxel of a surface, however it is turned; at 0.7 voxels 0.2 % are missed, at
  // one voxel 10 %.
  const double cell_m = config_.voxels.resolution_m / 2.0;
  for (auto it = keyframes_.begin(); it != keyframes_.end() && kept_bytes_ > budget_bytes; ++it) {
    DenseKeyframe& kept = it->second;
    if (std::exchange(kept.thinned, true) || cell_m <= config_.cloud_resolution_m) continue;
    kept_bytes_ -= bytesOf(kept.cloud, kept.view);
    kept.cloud.points = voxelFilter(kept.cloud.points, cell_m);
    kept_bytes_ += bytesOf(kept.cloud, kept.view);
  }
  if (kept_bytes_ <= budget_bytes) return;
  if (!std::exchange(warned_, true)) {
    logWarning("the dense map's keyframes fill dense.memory_mb (" + std::to_string(config_.memory_mb) +
               "): those that the sparse map has dropped are forgotten, those that it holds are not");
  }
  for (auto it = keyframes_.begin(); it != keyframes_.end() && kept_bytes_ > budget_bytes;) {
    it = it->second.culled ? forget(it) : std::next(it);
  }
}

void DenseMapper::forgetOldCulled() {
  const auto culled = static_cast<std::size_t>(
      std::count_if(keyframes_.begin(), keyframes_.end(), [](const auto& item) { return item.second.culled; }));
  const std::size_t most = kCulledPerHeld * (keyframes_.size() - culled);
  std::size_t too_many = culled - std::min(culled, most);
  for (auto it = keyframes_.begin(); it != keyframes_.end() && too_many > 0;) {
    if (it->second.culled) --too_many;
    it = it->second.culled ? forget(it) : std::next(it);
  }
}

std::map<KeyframeId, DenseKeyframe>::iterator DenseMapper::forget(
    std::map<KeyframeId, DenseKeyframe>::iterator keyframe) {
  kept_bytes_ -= bytesOf(keyframe->second.cloud, keyframe->second.view);
  served_.T_world_camera.erase(keyframe->first);
  if (next_) next_->T_world_camera.erase(keyframe->first);
  ++forgotten_;
  return keyframes_.erase(keyframe);
}

std::vector<LabelledPoint> DenseMapper::cloud() const {
  constexpr double kPoseErrorM = 0.015;
  std::vector<LabelledPoint> points;
  for (const auto& [id, T_world_camera] : served_.T_world_camera) {
    for (LabelledPoint point : keyframes_.at(id).cloud.points) {
      const auto depth_m = static_cast<double>(point.xyz_m[2]);
      point.xyz_m = transform(T_world_camera, point.xyz_m);
      // Farther from the surface than noise brings it, a point is of something else, which is gone.
      const double most_m = kPoseErrorM + 3.0 * config_.keyframe.depth_noise.surfaces_m * depth_m * depth_m;
      if (!served_.voxels.moveOntoSurface(point, most_m)) continue;
      const Voxel voxel = served_.voxels.voxelAt(point.position());
      if (voxel.state == Occupancy::kOccupied) points.push_back({point.xyz_m, point.bgr, voxel.label});
    }
  }
  return voxelFilter(points, config_.cloud_resolution_m);
}

std::vector<KeyframePose> DenseMapper::poses() const {
  std::vector<KeyframePose> poses;
  for (const auto& [id, T_world_camera] : served_.T_world_camera) {
    poses.push_back({id, keyframes_.at(id).cloud.stamp, T_world_camera});
  }
  return poses;
}

OccupancyGrid DenseMapper::projectedMap(const SE3& T_map_world) const {
  constexpr std::size_t kPatience = 20;  // keyframes without a floor, until it is said
  if (!config_.grid.find_floor) return projectToGrid(served_.voxels, T_map_world, config_.grid);
  const std::optional<Floor> floor = floorOf(served_.voxels, T_map_world, config_.grid);
  if (floor && std::exchange(floor_told_, FloorTold::kFound) != FloorTold::kFound) {
    char text[120];
    std::snprintf(text, sizeof(text), "floor found at %.2f m in the map frame, tilted by %.1f degrees",
                  floor->offset_m / floor->up.z(), floor->tiltDeg());
    logInfo(text);
  } else if (!floor && floor_told_ == FloorTold::kNothing && keyframes() >= kPatience) {
    floor_told_ = FloorTold::kMissing;
    logWarning("no floor is seen: the grid counts heights from dense.grid.floor_height_m of the map frame");
  }
  return floor ? projectToGrid(served_.voxels, T_map_world, config_.grid, *floor)
               : projectToGrid(served_.voxels, T_map_world, config_.grid);
}

void DenseMapper::saveCloud(const std::string& path) const { writePcd(cloud(), path); }

void DenseMapper::saveOctomap(const std::string& path) const { saveOctree(served_.voxels, path); }

void DenseMapper::saveForOthers(const std::string& folder) const {
  saveCloud(folder + "/cloud.pcd");
  saveOctomap(folder + "/map.ot");
  saveBinaryOctree(served_.voxels, folder + "/map.bt");
  const OccupancyGrid grid = projectedMap(SE3::Identity());
  if (!grid.cells.empty()) writeGrid(grid, folder + "/grid");
}

void DenseMapper::clearBox(const Eigen::AlignedBox3d& box_m) {
  finish();
  for (auto& [id, kept] : keyframes_) {
    const SE3& T_world_camera = kept.T_world_camera;
    std::vector<LabelledPoint>& points = kept.cloud.points;
    const auto inside = [&](const LabelledPoint& point) { return box_m.contains(T_world_camera * point.position()); };
    points.erase(std::remove_if(points.begin(), points.end(), inside), points.end());
  }
  next_.emplace(Version{VoxelMap(config_.voxels), {}});
  finish();
}

void DenseMapper::clear() {
  keyframes_.clear();
  kept_bytes_ = 0;
  next_.reset();
  served_ = Version{VoxelMap(config_.voxels), {}};
}

DenseMapContent DenseMapper::content(std::uint32_t map_id) const {
  DenseMapContent content{map_id, labels_, {}};
  for (const auto& [id, keyframe] : keyframes_) content.keyframes.push_back(keyframe);
  return content;
}

void DenseMapper::restore(std::vector<DenseKeyframe> keyframes) {
  clear();
  for (DenseKeyframe& keyframe : keyframes) {
    const KeyframeId id = keyframe.cloud.keyframe;
    if (!inReach(keyframe.T_world_camera)) continue;
    kept_bytes_ += bytesOf(keyframe.cloud, keyframe.view);
    const auto& kept = keyframes_.emplace(id, std::move(keyframe)).first->second;
    integrate(id, kept.T_world_camera, served_);
  }
  keepToBudget();
}

std::size_t DenseMapper::memoryBytes() const {
  return kept_bytes_ + served_.voxels.memoryBytes() + (next_ ? next_->voxels.memoryBytes() : 0);
}

}  // namespace semantic_vslam
