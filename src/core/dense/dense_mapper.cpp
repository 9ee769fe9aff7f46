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
#include "core/dense/surface_mesh.h"
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

std::size_t bytesOf(const DenseKeyframe& keyframe) {
  std::size_t bytes = bytesOf(keyframe.cloud, keyframe.view);
  for (const DenseLook& look : keyframe.looks) bytes += bytesOf(look.cloud, look.view);
  return bytes;
}

/// Points half a voxel apart hit every voxel of a surface, however it is turned; at 0.7 voxels 0.2 % are missed, at
/// one voxel 10 %.
double thinnedM(const DenseConfig& config) {
  return std::max(config.voxels.resolution_m / 2.0, config.cloud_resolution_m);
}

/// The keyframe nearest in time: ids are given in that order. Not the nearest in space, which may be of another visit
/// of the place, with other drift.
/// @param keyframes  a map by id, not empty
template <class Keyframes>
auto nearestInTime(Keyframes& keyframes, KeyframeId id) {
  const auto after = keyframes.lower_bound(id);
  if (after == keyframes.begin()) return after;
  const auto before = std::prev(after);
  if (after == keyframes.end()) return before;
  return after->first.value() - id.value() < id.value() - before->first.value() ? after : before;
}

}  // namespace

DenseMapper::DenseMapper(const DenseConfig& config, const LabelSet& labels)
    : config_(validated(config)), labels_(labels), served_(emptyVersion()) {}

bool DenseMapper::add(KeyframeId id, const RgbdFrame& frame, const cv::Mat1b& labels, const cv::Mat1b& dynamic,
                      const SE3& T_world_camera) {
  if (keyframes_.count(id) > 0 || !usable(frame, labels, dynamic, T_world_camera)) return false;
  const cv::Mat1b someone = someonePixels(frame.depth_m.size(), labels, dynamic, labels_);
  const cv::Mat1b excluded = excludedPixels(frame.depth_m, someone, config_.keyframe);
  DenseKeyframe kept;
  kept.order = next_order_++;
  kept.cloud = makeKeyframeCloud(id, frame, labels, excluded, config_.keyframe);
  kept.cloud.points = voxelFilter(kept.cloud.points, config_.cloud_resolution_m);
  kept.view = makeFreeSpaceView(frame, excluded, someone, config_.keyframe);
  kept.T_world_camera = T_world_camera;
  kept_bytes_ += bytesOf(kept);
  const DenseKeyframe& keyframe = keyframes_.emplace(id, std::move(kept)).first->second;
  if (busy()) due_.push_back({keyframe.order, id});
  // What is served stays of one piece during a rebuild: the keyframe goes where it lies among the old poses.
  integrate(keyframe, busy() ? poseAmong(served_.T_world_camera, id) : T_world_camera, served_);
  keepToBudget();  // only now: what is served has every keyframe in full
  work();
  return true;
}

bool DenseMapper::look(KeyframeId beside, const RgbdFrame& frame, const cv::Mat1b& labels, const cv::Mat1b& dynamic,
                       const SE3& T_world_camera) {
  if (keyframes_.empty() || !usable(frame, labels, dynamic, T_world_camera)) return false;
  DenseKeyframe& keyframe = nearestInTime(keyframes_, beside)->second;
  const KeyframeId id = keyframe.cloud.keyframe;
  const cv::Mat1b someone = someonePixels(frame.depth_m.size(), labels, dynamic, labels_);
  const cv::Mat1b excluded = excludedPixels(frame.depth_m, someone, config_.keyframe);
  DenseLook look;
  look.order = next_order_++;
  look.cloud = makeKeyframeCloud(id, frame, labels, excluded, config_.keyframe);
  look.cloud.points = voxelFilter(look.cloud.points, thinnedM(config_));
  look.view = makeFreeSpaceView(frame, excluded, someone, config_.keyframe);
  look.T_keyframe_camera = keyframe.T_world_camera.inverse() * T_world_camera;
  kept_bytes_ += bytesOf(look.cloud, look.view);
  integrate(look, served_);
  if (busy()) due_.push_back({look.order, id});
  if (keyframe.looks.size() == kLooks) {
    kept_bytes_ -= bytesOf(keyframe.looks.front().cloud, keyframe.looks.front().view);
    keyframe.looks.erase(keyframe.looks.begin());
  }
  keyframe.looks.push_back(std::move(look));
  keepToBudget();
  work();
  return true;
}

bool DenseMapper::usable(const RgbdFrame& frame, const cv::Mat1b& labels, const cv::Mat1b& dynamic,
                         const SE3& T_world_camera) {
  return frame.camera != nullptr && !frame.depth_m.empty() && fits(frame, labels) && fits(frame, dynamic) &&
         inReach(T_world_camera);
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

void DenseMapper::integrate(const DenseKeyframe& keyframe, const SE3& T_world_camera, Version& version) const {
  version.voxels.integrate(keyframe.cloud.points, keyframe.view, T_world_camera);
  version.T_world_camera[keyframe.cloud.keyframe] = T_world_camera;
  version.frames.push_back({keyframe.cloud.stamp, keyframe.cloud.keyframe});
}

/// Its keyframe is in the version already.
void DenseMapper::integrate(const DenseLook& look, Version& version) const {
  version.voxels.integrate(look.cloud.points, look.view,
                           version.T_world_camera.at(look.cloud.keyframe) * look.T_keyframe_camera);
  version.frames.push_back({look.cloud.stamp, look.cloud.keyframe});
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
  keepToBudget();  // what was made for who is served counts, too
  if (!busy() && stale()) startRebuild();
  work();
}

/// What keyframes saw last that had to go for want of memory: nobody can build it again.
void DenseMapper::carryOver(const Eigen::AlignedBox3d& forgotten_m) {
  std::map<std::uint32_t, std::uint32_t> numbers;
  const auto renumber = [&](std::uint32_t before) {
    const auto [number, is_new] = numbers.emplace(before, static_cast<std::uint32_t>(next_->frames.size() + 1));
    if (is_new) next_->frames.push_back(served_.frames[before - 1]);
    return number->second;
  };
  const double block_m = kBlockSide * config_.voxels.resolution_m;
  const auto is_left = [&](const VoxelBlock& block) {
    const Eigen::Vector3d low = blockCorner(block.key).cast<double>() * config_.voxels.resolution_m;
    const Eigen::AlignedBox3d box(low, low.array() + block_m);
    return let_go_.count(served_.frames[block.changed - 1].keyframe) > 0 && !box.intersects(forgotten_m);
  };
  next_->voxels.takeOver(served_.voxels, is_left, renumber);
  std::set<KeyframeId> left;
  for (const Integrated& frame : next_->frames) left.insert(frame.keyframe);
  let_go_.swap(left);
}

void DenseMapper::startRebuild(const Eigen::AlignedBox3d& forgotten_m) {
  next_.emplace(emptyVersion());
  if (!let_go_.empty()) carryOver(forgotten_m);
  due_.clear();
  for (const auto& [id, keyframe] : keyframes_) {
    due_.push_back({keyframe.order, id});
    for (const DenseLook& look : keyframe.looks) due_.push_back({look.order, id});
  }
  std::sort(due_.begin(), due_.end(), [](const Due& a, const Due& b) { return a.order < b.order; });
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
  for (int budget = config_.rebuild_keyframes_per_call; !due_.empty(); --budget) {
    if (budget == 0) return;
    const Due due = due_.front();
    due_.pop_front();
    const auto keyframe = keyframes_.find(due.keyframe);
    if (keyframe == keyframes_.end()) continue;  // forgotten meanwhile, as a look may be
    const DenseKeyframe& kept = keyframe->second;
    if (kept.order == due.order) integrate(kept, kept.T_world_camera, *next_);
    for (const DenseLook& look : kept.looks) {
      if (look.order == due.order) integrate(look, *next_);
    }
    keepVoxelsToBudget(*next_);
  }
  served_ = std::move(*next_);
  next_.reset();
  ++rebuilds_;
  // Poses that moved during the rebuild: once more, later. Never start over before one is complete.
  if (stale()) startRebuild();
}

void DenseMapper::finish() {
  while (busy()) work();
}

std::size_t DenseMapper::neededBytes() const {
  const std::size_t voxels = std::max(served_.voxels.memoryBytes(), next_ ? next_->voxels.memoryBytes() : 0);
  return kept_bytes_ + 2 * voxels + served_.partsBytes();
}

void DenseMapper::keepToBudget() {
  const auto tooMany = [&] { return neededBytes() > budgetBytes(); };
  for (auto it = keyframes_.begin(); it != keyframes_.end() && tooMany(); ++it) {
    kept_bytes_ -= bytesOf(it->second);
    it->second.looks.clear();
    kept_bytes_ += bytesOf(it->second);
  }
  for (auto it = keyframes_.begin(); it != keyframes_.end() && tooMany(); ++it) {
    DenseKeyframe& kept = it->second;
    if (std::exchange(kept.thinned, true) || thinnedM(config_) <= config_.cloud_resolution_m) continue;
    kept_bytes_ -= bytesOf(kept);
    kept.cloud.points = voxelFilter(kept.cloud.points, thinnedM(config_));
    kept_bytes_ += bytesOf(kept);
  }
  if (neededBytes() <= budgetBytes()) return;
  if (!std::exchange(warned_, true)) {
    logWarning("the dense map fills dense.memory_mb (" + std::to_string(config_.memory_mb) +
               "): of keyframes that the sparse map has dropped and of those far away only the voxels stay, and where "
               "these are too many, those near the camera");
  }
  for (auto it = keyframes_.begin(); it != keyframes_.end() && tooMany();) {
    it = it->second.culled ? forget(it) : std::next(it);
  }
  letGoFarKeyframes();
  if (served_.partsBytes() > budgetBytes() / 3) forgetParts();
  keepVoxelsToBudget(served_);
}

/// A third of the memory is the keyframes', whatever the voxels need.
void DenseMapper::letGoFarKeyframes() {
  if (keyframes_.empty()) return;
  const std::size_t least_bytes = budgetBytes() / 3;
  const Eigen::Vector3d here = keyframes_.rbegin()->second.T_world_camera.translation();
  std::vector<std::pair<double, KeyframeId>> far_m;
  for (const auto& [id, kept] : keyframes_) far_m.emplace_back((kept.T_world_camera.translation() - here).norm(), id);
  far_m.pop_back();  // the newest stays
  std::stable_sort(far_m.begin(), far_m.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  for (const auto& [distance_m, id] : far_m) {
    if (kept_bytes_ <= least_bytes || neededBytes() <= budgetBytes()) return;
    let_go_.insert(id);
    forget(keyframes_.find(id));
  }
}

void DenseMapper::keepVoxelsToBudget(Version& version) const {
  if (keyframes_.empty() || neededBytes() <= budgetBytes()) return;
  constexpr double kRoom = 0.95;  // not with every keyframe again
  const std::size_t others = std::min(kept_bytes_ + served_.partsBytes(), budgetBytes() * 2 / 3);
  const double most = kRoom * static_cast<double>(budgetBytes() - others) / 2.0;
  version.voxels.forgetFarthest(keyframes_.rbegin()->second.T_world_camera.translation(),
                                static_cast<std::size_t>(most));
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
  kept_bytes_ -= bytesOf(keyframe->second);
  served_.T_world_camera.erase(keyframe->first);
  if (next_) next_->T_world_camera.erase(keyframe->first);
  ++forgotten_;
  return keyframes_.erase(keyframe);
}

const SurfaceCloud& DenseMapper::surfaceCloud() const {
  std::vector<CloudSource> sources;
  for (const auto& [id, T_world_camera] : served_.T_world_camera) {
    const DenseKeyframe& keyframe = keyframes_.at(id);
    sources.push_back({keyframe.order, &keyframe.cloud.points, T_world_camera});
    for (const DenseLook& look : keyframe.looks) {
      sources.push_back({look.order, &look.cloud.points, T_world_camera * look.T_keyframe_camera});
    }
  }
  std::sort(sources.begin(), sources.end(), [](const auto& a, const auto& b) { return a.order < b.order; });
  served_.cloud.update(
      served_.voxels, sources,
      {config_.cloud_resolution_m, config_.keyframe.depth_noise.surfaces_m, config_.keyframe.max_depth_m});
  return served_.cloud;
}

void DenseMapper::forgetParts() const {
  served_.octree = OctreeStream();
  served_.cloud = SurfaceCloud();
  served_.grid = GridProjection();
  served_.floor.reset();
}

SurfaceEvidence DenseMapper::evidenceAt(const Eigen::Vector3d& point_world) const {
  const Voxel voxel = served_.voxels.voxelAt(point_world);
  return {voxel.label_share, voxel.last_hit > 0 ? served_.frames[voxel.last_hit - 1].stamp : Stamp()};
}

std::vector<KeyframePose> DenseMapper::poses() const {
  std::vector<KeyframePose> poses;
  for (const auto& [id, T_world_camera] : served_.T_world_camera) {
    poses.push_back({id, keyframes_.at(id).cloud.stamp, T_world_camera});
  }
  return poses;
}

std::vector<TimedPose> DenseMapper::views() const {
  std::vector<TimedPose> views;
  for (const auto& [id, T_world_camera] : served_.T_world_camera) {
    const DenseKeyframe& keyframe = keyframes_.at(id);
    views.push_back({keyframe.cloud.stamp, T_world_camera});
    for (const DenseLook& look : keyframe.looks) {
      views.push_back({look.cloud.stamp, T_world_camera * look.T_keyframe_camera});
    }
  }
  std::sort(views.begin(), views.end(), [](const auto& a, const auto& b) { return a.stamp < b.stamp; });
  return views;
}

std::optional<Floor> DenseMapper::floor(const SE3& T_map_world) const {
  constexpr std::size_t kPatience = 20;  // keyframes without a floor, until it is said
  constexpr std::size_t kChange = 10;    // the reciprocal share of the surface
  std::optional<HeldFloor>& held = served_.floor;
  if (!held || !held->T_map_world.isApprox(T_map_world, 0.0) ||
      kChange * (served_.grid.occupiedChanges() - held->occupied_changes) >= served_.grid.occupied()) {
    held = {T_map_world, served_.grid.occupiedChanges(), floorOf(served_.voxels, T_map_world, config_.grid)};
  }
  const std::optional<Floor>& floor = held->floor;
  if (floor && std::exchange(floor_told_, FloorTold::kFound) != FloorTold::kFound) {
    char text[120];
    std::snprintf(text, sizeof(text), "floor found at %.2f m in the map frame, tilted by %.1f degrees",
                  floor->offset_m / floor->up.z(), floor->tiltDeg());
    logInfo(text);
  } else if (!floor && floor_told_ == FloorTold::kNothing && keyframes() >= kPatience) {
    floor_told_ = FloorTold::kMissing;
    logWarning("no floor is seen: the grid counts heights from dense.grid.floor_height_m of the map frame");
  }
  return floor;
}

OccupancyGrid DenseMapper::projectedMap(const SE3& T_map_world) const {
  served_.grid.update(served_.voxels);
  const std::optional<Floor> seen = config_.grid.find_floor ? floor(T_map_world) : std::nullopt;
  const Floor level{Eigen::Vector3d::UnitZ(), config_.grid.floor_height_m};
  return served_.grid.project(T_map_world, config_.grid, seen.value_or(level));
}

void DenseMapper::saveCloud(const std::string& path) const { writePcd(cloud(), labels_, path); }

DenseMapper::Version DenseMapper::emptyVersion() const {
  return {VoxelMap(config_.voxels), {}, {}, {}, {}, {}, std::nullopt};
}

const OctreeStream& DenseMapper::octree() const {
  served_.octree.update(served_.voxels);
  return served_.octree;
}

void DenseMapper::saveOctomap(const std::string& path) const { saveOctree(octree(), path); }

void DenseMapper::saveForOthers(const std::string& folder) const {
  saveCloud(folder + "/cloud.pcd");
  saveOctomap(folder + "/map.ot");
  saveMesh(folder + "/mesh.ply");
  saveBinaryOctree(octree(), folder + "/map.bt");
  const OccupancyGrid grid = projectedMap(SE3::Identity());
  if (!grid.cells.empty()) writeGrid(grid, folder + "/grid");
}

void DenseMapper::clearBox(const Eigen::AlignedBox3d& box_m) {
  finish();
  const auto forgetInside = [&](std::vector<LabelledPoint>& points, const SE3& T_world_camera) {
    const auto inside = [&](const LabelledPoint& point) { return box_m.contains(T_world_camera * point.position()); };
    points.erase(std::remove_if(points.begin(), points.end(), inside), points.end());
  };
  for (auto& [id, kept] : keyframes_) {
    forgetInside(kept.cloud.points, kept.T_world_camera);
    for (DenseLook& look : kept.looks) forgetInside(look.cloud.points, kept.T_world_camera * look.T_keyframe_camera);
  }
  startRebuild(box_m);
  finish();
}

void DenseMapper::saveMesh(const std::string& path) const { writePly(makeSurfaceMesh(served_.voxels), labels_, path); }

void DenseMapper::clear() {
  keyframes_.clear();
  kept_bytes_ = 0;
  next_order_ = 0;
  let_go_.clear();
  next_.reset();
  served_ = emptyVersion();
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
    kept_bytes_ += bytesOf(keyframe);
    next_order_ = std::max(next_order_, 1 + (keyframe.looks.empty() ? keyframe.order : keyframe.looks.back().order));
    keyframes_.emplace(id, std::move(keyframe));
  }
  keepToBudget();
  startRebuild();
  finish();
}

std::size_t DenseMapper::memoryBytes() const {
  return kept_bytes_ + served_.voxels.memoryBytes() + (next_ ? next_->voxels.memoryBytes() : 0) + served_.partsBytes();
}

}  // namespace semantic_vslam
