// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/dense/surface_cloud.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace semantic_vslam {
namespace {

constexpr double kPoseErrorM = 0.015;
constexpr std::size_t kNodeBytes = 6 * sizeof(void*);  // of a map, about

/// Farther from the surface than noise brings it, a point is of something else, which is gone.
double mostOffM(double depth_m, const SurfaceCloudConfig& config) {
  return kPoseErrorM + 3.0 * config.noise_m_per_m2 * depth_m * depth_m;
}

/// How far from a point's own place the part may lie that it ends up in.
double reachM(double depth_m, const SurfaceCloudConfig& config) {
  return VoxelMap::SurfaceReader::kMost * mostOffM(depth_m, config) + config.cell_m;
}

void makeUnique(std::vector<VoxelKey>& keys) {
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
}

/// With all blocks within so many blocks of them.
std::vector<VoxelKey> grown(const std::vector<VoxelKey>& keys, int by) {
  std::vector<VoxelKey> result;
  for (const VoxelKey key : keys) {
    const Eigen::Vector3i corner = blockCorner(key);
    for (int x = -by; x <= by; ++x) {
      for (int y = -by; y <= by; ++y) {
        for (int z = -by; z <= by; ++z) {
          const Eigen::Vector3i other = corner + kBlockSide * Eigen::Vector3i(x, y, z);
          if (inVoxelRange(other)) result.push_back(blockKey(voxelKey(other)));
        }
      }
    }
  }
  makeUnique(result);
  return result;
}

/// As the float of a LabelledPoint has it.
LabelledPoint inWorld(const LabelledPoint& point, const SE3& T_world_camera) {
  const Eigen::Vector3f p = (T_world_camera * point.position()).cast<float>();
  return {cv::Vec3f(p.x(), p.y(), p.z()), point.bgr, point.label};
}

/// The block that holds the middle of a point's cube: all points of a cube go to one part.
std::optional<VoxelKey> partOf(const Eigen::Vector3d& point, double cell_m, double voxel_m) {
  const Eigen::Vector3d middle = (voxelIndexAt(point, cell_m).cast<double>().array() + 0.5) * cell_m;
  const Eigen::Vector3i index = voxelIndexAt(middle, voxel_m);
  if (!inVoxelRange(index)) return std::nullopt;
  return blockKey(voxelKey(index));
}

}  // namespace

void SurfaceCloud::update(const VoxelMap& map, const std::vector<CloudSource>& sources,
                          const SurfaceCloudConfig& config) {
  Keys changed = takeChanges(map);
  takeSources(map, sources, changed);
  if (changed.empty()) return;
  makeUnique(changed);
  // A part is made of points within reach, which look at voxels within reach of themselves and one and a half more.
  const double block_m = kBlockSide * map.resolution(), reach_m = reachM(config.max_depth_m, config);
  const int blocks = static_cast<int>(std::ceil((reach_m + 1.5 * map.resolution()) / block_m));
  const Keys parts = grown(changed, blocks);
  make(parts, grown(parts, blocks), map, sources, config);
}

SurfaceCloud::Keys SurfaceCloud::takeChanges(const VoxelMap& map) {
  Keys changed;
  const std::vector<VoxelBlock>& blocks = map.blocks();
  blocks_.resize(blocks.size());
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    VoxelBlock& before = blocks_[i];
    if (before.key == blocks[i].key && blocks[i].surface_changed <= revision_) continue;
    if (before.key != blocks[i].key && before.key != VoxelBlock::kNone) changed.push_back(before.key);
    before = blocks[i];
    if (before.key != VoxelBlock::kNone && before.surface_changed > 0) changed.push_back(before.key);
  }
  revision_ = map.revision();
  return changed;
}

void SurfaceCloud::takeSources(const VoxelMap& map, const std::vector<CloudSource>& sources, Keys& changed) {
  auto known = sources_.begin();
  const auto drop = [&] {
    changed.insert(changed.end(), known->second.blocks.begin(), known->second.blocks.end());
    const auto gone = known++;
    forget(gone);
  };
  for (const CloudSource& source : sources) {
    while (known != sources_.end() && known->first < source.order) drop();
    if (known != sources_.end() && known->first == source.order) {
      if (known->second.points == source.points->size()) {
        ++known;
        continue;
      }
      drop();  // thinned
    }
    index(source, map.resolution());
    const Keys& blocks = sources_.at(source.order).blocks;
    changed.insert(changed.end(), blocks.begin(), blocks.end());
  }
  while (known != sources_.end()) drop();
}

void SurfaceCloud::index(const CloudSource& source, double voxel_m) {
  Indexed& indexed = sources_[source.order];
  indexed.points = source.points->size();
  std::vector<KeyedPoint> keyed;
  keyed.reserve(source.points->size());
  for (std::size_t i = 0; i < source.points->size(); ++i) {
    const LabelledPoint point = inWorld((*source.points)[i], source.T_world_camera);
    const Eigen::Vector3i voxel = voxelIndexAt(point.position(), voxel_m);
    if (inVoxelRange(voxel)) keyed.push_back({blockKey(voxelKey(voxel)), static_cast<std::uint32_t>(i)});
  }
  std::sort(keyed.begin(), keyed.end(), [](const KeyedPoint& a, const KeyedPoint& b) {
    return a.key != b.key ? a.key < b.key : a.index < b.index;
  });
  indexed.by_block.reserve(keyed.size());
  for (std::size_t i = 0; i < keyed.size(); ++i) {
    indexed.by_block.push_back(keyed[i].index);
    if (i == 0 || keyed[i].key != keyed[i - 1].key) {
      indexed.blocks.push_back(keyed[i].key);
      runs_[keyed[i].key].push_back({source.order, static_cast<std::uint32_t>(i), 0});
    }
    runs_[keyed[i].key].back().end = static_cast<std::uint32_t>(i + 1);
  }
  indexed.blocks.shrink_to_fit();
  bytes_ += indexed.bytes();
}

std::size_t SurfaceCloud::Indexed::bytes() const {
  return sizeof(Indexed) + kNodeBytes + by_block.capacity() * sizeof(std::uint32_t) +
         blocks.capacity() * (sizeof(VoxelKey) + 2 * sizeof(Run));
}

void SurfaceCloud::forget(std::map<std::uint64_t, Indexed>::iterator source) {
  for (const VoxelKey block : source->second.blocks) {
    const auto runs = runs_.find(block);
    const auto is_of_it = [&](const Run& run) { return run.order == source->first; };
    runs->second.erase(std::remove_if(runs->second.begin(), runs->second.end(), is_of_it), runs->second.end());
    if (runs->second.empty()) runs_.erase(runs);
  }
  bytes_ -= source->second.bytes();
  sources_.erase(source);
}

/// @param parts  to be made anew  @param near  blocks whose points may end up in them
void SurfaceCloud::make(const Keys& parts, const Keys& near, const VoxelMap& map,
                        const std::vector<CloudSource>& sources, const SurfaceCloudConfig& config) {
  std::unordered_map<VoxelKey, std::vector<LabelledPoint>> made;
  for (const VoxelKey part : parts) made.emplace(part, std::vector<LabelledPoint>());
  const double block_m = kBlockSide * map.resolution();
  const auto anyWithin = [&](const Eigen::Vector3d& point, double reach_m) {
    const Eigen::Vector3i low = voxelIndexAt(point.array() - reach_m, block_m) * kBlockSide;
    const Eigen::Vector3i high = voxelIndexAt(point.array() + reach_m, block_m) * kBlockSide;
    if (!inVoxelRange(low) || !inVoxelRange(high)) return false;
    for (int x = low.x(); x <= high.x(); x += kBlockSide) {
      for (int y = low.y(); y <= high.y(); y += kBlockSide) {
        for (int z = low.z(); z <= high.z(); z += kBlockSide) {
          if (made.count(blockKey(voxelKey({x, y, z}))) > 0) return true;
        }
      }
    }
    return false;
  };
  VoxelMap::SurfaceReader surface(map);
  const auto take = [&](const CloudSource& source, const Run& run, bool inside) {
    const Indexed& indexed = sources_.at(run.order);
    for (std::uint32_t i = run.begin; i < run.end; ++i) {
      const LabelledPoint& seen = (*source.points)[indexed.by_block[i]];
      const auto depth_m = static_cast<double>(seen.xyz_m[2]);
      LabelledPoint point = inWorld(seen, source.T_world_camera);
      if (!inside && !anyWithin(point.position(), reachM(depth_m, config))) continue;
      if (!surface.moveOntoSurface(point, mostOffM(depth_m, config))) continue;
      const std::optional<std::uint8_t> label = surface.labelAt(point.position());
      const std::optional<VoxelKey> part = partOf(point.position(), config.cell_m, map.resolution());
      if (!label || !part) continue;
      const auto bucket = made.find(*part);
      if (bucket == made.end()) continue;
      point.label = *label;
      bucket->second.push_back(point);
    }
  };
  const auto earlier = [](const CloudSource& source, std::uint64_t order) { return source.order < order; };
  for (const VoxelKey block : near) {  // block by block: what a frame saw lies all over the memory
    const auto runs = runs_.find(block);
    if (runs == runs_.end()) continue;
    for (const Run& run : runs->second) {
      take(*std::lower_bound(sources.begin(), sources.end(), run.order, earlier), run, made.count(block) > 0);
    }
  }
  for (const VoxelKey part : parts) set(part, voxelFilter(made.at(part), config.cell_m));
}

void SurfaceCloud::set(VoxelKey part, std::vector<LabelledPoint> points) {
  const auto before = parts_.find(part);
  if (before != parts_.end()) {
    bytes_ -= kNodeBytes + before->second.capacity() * sizeof(LabelledPoint);
    parts_.erase(before);
  }
  if (points.empty()) return;
  bytes_ += kNodeBytes + points.capacity() * sizeof(LabelledPoint);
  parts_.emplace(part, std::move(points));
}

std::size_t SurfaceCloud::size() const {
  std::size_t count = 0;
  for (const auto& [key, part] : parts_) count += part.size();
  return count;
}

void SurfaceCloud::forEachPart(const std::function<void(const std::vector<LabelledPoint>&)>& visit) const {
  for (const auto& [key, part] : parts_) visit(part);
}

std::vector<LabelledPoint> SurfaceCloud::points() const {
  std::vector<LabelledPoint> all;
  all.reserve(size());
  forEachPart([&](const std::vector<LabelledPoint>& part) { all.insert(all.end(), part.begin(), part.end()); });
  return all;
}

}  // namespace semantic_vslam
