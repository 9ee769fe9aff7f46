// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/dense/voxel_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <unordered_map>
#include <utility>

#include "core/dense/label_votes.h"
#include "core/dense/surface_distance.h"
#include "core/dense/voxel_key.h"
#include "semantic_vslam/core/common/config_fields.h"

namespace semantic_vslam {
namespace {

using LogOdds = std::int16_t;  // in thousandths: exact sums, the same on every machine
constexpr double kLogOddsUnit = 0.001;
constexpr LogOdds kUnknown = std::numeric_limits<LogOdds>::min();
constexpr float kHalfDiagonal = 0.866F;  // of a unit cube
// A voxel with points of one keyframe is doubted after so many keyframes: that saw nothing at it; that had it in view.
constexpr int kDoubtsUntilGone = 3;
constexpr int kViewsToConfirm = 10;

LogOdds logOdds(double probability) {
  return static_cast<LogOdds>(std::lround(std::log(probability / (1.0 - probability)) / kLogOddsUnit));
}

/// What is kept of a voxel that ever held a point.
struct Surface {
  std::uint32_t last_hit = 0;          ///< keyframe counter
  std::uint16_t hits = 0, misses = 0;  ///< saturate, as all counts here
  /// Keyframes since the last hit: that looked through it; that saw nothing before or at it, though no ray surely
  /// passed; that had it in view, hidden or not.
  std::uint16_t misses_since_hit = 0, doubts_since_hit = 0, views_since_hit = 0;
  std::uint16_t someone = 0;  ///< keyframes that saw a person or a moving thing here, since one looked through it
  std::array<std::uint16_t, 3> bgr_256ths{};  ///< running mean
  LabelVotes votes;
};

void countUp(std::uint16_t& count) {
  if (count < std::numeric_limits<std::uint16_t>::max()) ++count;
}

struct Block {
  std::uint32_t place = 0;  // in VoxelMap::blocks()
  std::uint32_t bytes = 0;  // as counted last
  std::array<LogOdds, kBlockVoxels> log_odds;
  std::vector<std::uint16_t> slot;  // place + 1 in surfaces, 0 = none; empty in a block that was only ever seen free
  std::vector<Surface> surfaces;
  std::vector<FusedDistance> distances;  // empty in a block that no surface came near

  Block() { log_odds.fill(kUnknown); }

  std::size_t memoryBytes() const {
    return sizeof(Block) + slot.capacity() * sizeof(std::uint16_t) + surfaces.capacity() * sizeof(Surface) +
           distances.capacity() * sizeof(FusedDistance) + sizeof(VoxelBlock) + 4 * sizeof(void*);
  }
  const FusedDistance* distance(int local) const {
    return distances.empty() || !distances[local].known() ? nullptr : &distances[local];
  }
  const Surface* surface(int local) const {
    return slot.empty() || slot[local] == 0 ? nullptr : &surfaces[slot[local] - 1];
  }
  Surface* surface(int local) { return const_cast<Surface*>(static_cast<const Block*>(this)->surface(local)); }

  Surface& makeSurface(int local) {
    if (slot.empty()) slot.assign(kBlockVoxels, 0);
    if (slot[local] == 0) {
      surfaces.emplace_back();
      slot[local] = static_cast<std::uint16_t>(surfaces.size());
    }
    return surfaces[slot[local] - 1];
  }
};

/// What one keyframe's points say of one voxel.
struct Observation {
  cv::Vec3d bgr;
  LabelVotes votes;
  int points = 0;

  void add(const LabelledPoint& point) {
    bgr += cv::Vec3d(point.bgr);
    votes.add(point.label);
    ++points;
  }
};

/// A keyframe counts once, however many points it has: a voxel seen from near would otherwise never change again.
void fuse(const Observation& observation, Surface& surface) {
  constexpr int kColourMemory = 30;  // keyframes; older light fades
  countUp(surface.hits);
  const int weight = std::min<int>(surface.hits, kColourMemory);
  for (int channel = 0; channel < 3; ++channel) {
    const double mean = 256.0 * observation.bgr[channel] / observation.points;
    double value = surface.bgr_256ths[channel];
    value += (mean - value) / weight;
    surface.bgr_256ths[channel] = static_cast<std::uint16_t>(std::lround(std::clamp(value, 0.0, 65535.0)));
  }
  surface.votes.add(observation.votes.winner());
}

/// Depth up to which a voxel's centre is certainly in free space, for every cell of a view and for voxels of several
/// sizes in the image: the nearest surface within the voxel's outline counts.
class FreeLimits {
 public:
  FreeLimits(const FreeSpaceView& view, const VoxelMapConfig& config)
      : voxel_radius_cells_at_1m_(view.fx_cells * kHalfDiagonal * config.resolution_m) {
    cv::Mat1f free_m;
    view.free_mm.convertTo(free_m, CV_32F, 0.001);
    const cv::Mat silent = (view.free_mm == 0) | (view.free_mm == FreeSpaceView::kNoReturn);
    free_m.setTo(1e6F, silent);  // a silent cell limits only itself
    for (int i = 0; i < kTables; ++i) {
      const int side = 2 * (1 << i) + 1;
      cv::erode(free_m, tables_[i], cv::getStructuringElement(cv::MORPH_RECT, {side, side}));
      for (float& z_m : tables_[i]) z_m = limit(z_m, config);
      tables_[i].setTo(0.0F, silent);
    }
    double farthest = 0.0;
    cv::minMaxLoc(tables_[0], nullptr, &farthest);
    farthest_m_ = static_cast<float>(farthest);
  }

  /// @return limits in metres, a cell each, for voxels at this depth; 0 = says nothing.
  const cv::Mat1f& at(float z_m) const {
    int table = 0;
    while (table + 1 < kTables && (1 << table) + 0.5 < voxel_radius_cells_at_1m_ / z_m) ++table;
    return tables_[table];
  }
  float farthest() const { return farthest_m_; }

 private:
  static float limit(float free_m, const VoxelMapConfig& config) {
    const double in_range_m = std::min<double>(free_m, config.free_range_m);
    return static_cast<float>(std::max(0.0, in_range_m - kHalfDiagonal * config.resolution_m));
  }

  static constexpr int kTables = 4;  // radius 1, 2, 4, 8 cells
  double voxel_radius_cells_at_1m_;
  std::array<cv::Mat1f, kTables> tables_;
  float farthest_m_ = 0.0F;
};

}  // namespace

struct VoxelMap::Impl {
  explicit Impl(const VoxelMapConfig& map_config)
      : config(map_config),
        hit(logOdds(config.hit_probability)),
        missed(logOdds(config.miss_probability)),
        lowest(logOdds(config.min_probability)),
        highest(logOdds(config.max_probability)),
        truncation_m(truncationM(config.resolution_m)) {}

  void change(LogOdds& value, LogOdds step) {
    if (value == kUnknown) {
      value = 0;
      ++known;
    }
    value = std::clamp<LogOdds>(static_cast<LogOdds>(value + step), lowest, highest);
  }
  const Block* find(VoxelKey block_key) const {
    const auto found = blocks.find(block_key);
    return found == blocks.end() ? nullptr : &found->second;
  }
  Block& make(VoxelKey block_key) {
    const auto [it, is_new] = blocks.try_emplace(block_key);
    if (is_new) {
      if (free_places.empty()) {
        free_places.push_back(static_cast<std::uint32_t>(places.size()));
        places.emplace_back();
      }
      it->second.place = free_places.back();
      free_places.pop_back();
      places[it->second.place] = {block_key, keyframes, 0};
    }
    return it->second;
  }
  void markChanged(const Block& block, bool surface) {
    VoxelBlock& place = places[block.place];
    place.changed = keyframes;
    if (surface) place.surface_changed = keyframes;
  }
  void count(Block& block) {
    const std::size_t now = block.memoryBytes();
    bytes += now - block.bytes;
    block.bytes = static_cast<std::uint32_t>(now);
  }

  void insertPoints(const std::vector<LabelledPoint>& points, const SE3& T_world_camera);
  void hitVoxel(VoxelKey key, const Observation& observation);
  void carve(const FreeSpaceView& view, const SE3& T_world_camera);
  void carveBlock(const Eigen::Vector3i& block_index, const SE3& T_camera_world, const FreeSpaceView& view,
                  const FreeLimits& limits, const SurfaceDistance& surfaces);
  struct News {
    bool any = false, surface = false;
  };
  News miss(Block& block, int local);
  template <class Is>
  bool anyBeside(const Block& block, int local, const Is& is) const;
  Occupancy state(const Block& block, int local) const;
  Voxel describe(const Eigen::Vector3i& index, const Block* block, int local) const;

  VoxelMapConfig config;
  LogOdds hit, missed, lowest, highest;
  float truncation_m;
  std::unordered_map<VoxelKey, Block> blocks;  // by blockKey(); walked in sorted order only
  std::vector<VoxelBlock> places;
  std::vector<std::uint32_t> free_places;
  std::uint32_t keyframes = 0;
  std::size_t known = 0, bytes = 0;
};

void VoxelMap::Impl::insertPoints(const std::vector<LabelledPoint>& points, const SE3& T_world_camera) {
  const std::vector<KeyedPoint> keyed = sortByVoxel(points, T_world_camera, config.resolution_m);
  Observation observation;
  for (std::size_t i = 0; i < keyed.size(); ++i) {
    observation.add(points[keyed[i].index]);
    if (i + 1 == keyed.size() || keyed[i + 1].key != keyed[i].key) {
      hitVoxel(keyed[i].key, observation);
      observation = Observation();
    }
  }
}

void VoxelMap::Impl::hitVoxel(VoxelKey key, const Observation& observation) {
  Block& block = make(blockKey(key));
  const int local = static_cast<int>(key & (kBlockVoxels - 1));
  change(block.log_odds[local], hit);
  Surface& surface = block.makeSurface(local);
  surface.last_hit = keyframes;
  surface.misses_since_hit = surface.doubts_since_hit = surface.views_since_hit = 0;
  fuse(observation, surface);
  markChanged(block, true);
  count(block);
}

void VoxelMap::Impl::carve(const FreeSpaceView& view, const SE3& T_world_camera) {
  const FreeLimits limits(view, config);
  if (limits.farthest() <= 0.0F) return;
  const SurfaceDistance surfaces(view);
  const double block_m = kBlockSide * config.resolution_m;
  // Blocks in the box around the camera and the four corners of its view at the farthest free depth.
  Eigen::Vector3d low = T_world_camera.translation(), high = low;
  for (const double col : {-0.5, view.free_mm.cols - 0.5}) {
    for (const double row : {-0.5, view.free_mm.rows - 0.5}) {
      const Eigen::Vector3d ray((col - view.cx_cells) / view.fx_cells, (row - view.cy_cells) / view.fy_cells, 1.0);
      const Eigen::Vector3d corner = T_world_camera * (ray * (limits.farthest() + 2.0 * truncation_m));
      low = low.cwiseMin(corner);
      high = high.cwiseMax(corner);
    }
  }
  const Eigen::Vector3i first = voxelIndexAt(low, block_m), last = voxelIndexAt(high, block_m);
  if (!inVoxelRange(first * kBlockSide) || !inVoxelRange((last + Eigen::Vector3i::Ones()) * kBlockSide)) return;
  const SE3 T_camera_world = T_world_camera.inverse();
  Eigen::Vector3i index;
  for (index.x() = first.x(); index.x() <= last.x(); ++index.x()) {
    for (index.y() = first.y(); index.y() <= last.y(); ++index.y()) {
      for (index.z() = first.z(); index.z() <= last.z(); ++index.z())
        carveBlock(index, T_camera_world, view, limits, surfaces);
    }
  }
}

void VoxelMap::Impl::carveBlock(const Eigen::Vector3i& block_index, const SE3& T_camera_world,
                                const FreeSpaceView& view, const FreeLimits& limits, const SurfaceDistance& surfaces) {
  const double voxel_m = config.resolution_m, block_m = kBlockSide * voxel_m;
  const Eigen::Vector3d centre = T_camera_world * ((block_index.cast<double>().array() + 0.5) * block_m).matrix();
  const double radius_m = kHalfDiagonal * block_m;
  if (centre.z() + radius_m <= 0.0 || centre.z() - radius_m >= limits.farthest() + 2.0 * truncation_m) return;
  if (centre.z() > 2.0 * radius_m) {  // outside the image for sure?
    const double nearest_z = centre.z() - radius_m;
    const double u = view.fx_cells * centre.x() / centre.z() + view.cx_cells;
    const double v = view.fy_cells * centre.y() / centre.z() + view.cy_cells;
    // The sphere's outline is within radius/nearest_z * (1 + tan) of its centre; 2 covers views up to 90 degrees.
    const double reach = 2.0 * std::max(view.fx_cells, view.fy_cells) * radius_m / nearest_z;
    if (u < -reach || v < -reach || u > view.free_mm.cols + reach || v > view.free_mm.rows + reach) return;
  }
  const cv::Mat1f& limit_m = limits.at(static_cast<float>(std::max(centre.z() - radius_m, 0.1)));
  const Eigen::Matrix3f step = (T_camera_world.linear() * voxel_m).cast<float>();
  const Eigen::Vector3f first_voxel =
      (T_camera_world * (((block_index * kBlockSide).cast<double>().array() + 0.5) * voxel_m).matrix()).cast<float>();
  const auto fx = static_cast<float>(view.fx_cells), fy = static_cast<float>(view.fy_cells);
  const auto cx = static_cast<float>(view.cx_cells) + 0.5F, cy = static_cast<float>(view.cy_cells) + 0.5F;
  const float cols = static_cast<float>(limit_m.cols), rows = static_cast<float>(limit_m.rows);
  const VoxelKey key = blockKey(voxelKey(block_index * kBlockSide));
  auto* block = const_cast<Block*>(find(key));
  bool changed = false, surface_changed = false;  // what is served; counts that only lead there are not
  const auto noise = static_cast<float>(view.noise_m_per_m2);
  for (int local = 0; local < kBlockVoxels; ++local) {
    const auto i = static_cast<float>(local >> 6), j = static_cast<float>((local >> 3) & 7),
               k = static_cast<float>(local & 7);
    const Eigen::Vector3f p = first_voxel + step.col(0) * i + step.col(1) * j + step.col(2) * k;
    if (p.z() <= 0.0F) continue;
    const float inverse_z = 1.0F / p.z();
    const float u = fx * p.x() * inverse_z + cx, v = fy * p.y() * inverse_z + cy;
    if (!(u >= 0.0F && v >= 0.0F && u < cols && v < rows)) continue;
    const int row = static_cast<int>(v), col = static_cast<int>(u);
    const bool free = p.z() < limit_m(row, col);
    if (free && block == nullptr) block = &make(key);
    if (!free || !block->distances.empty()) {
      const float distance_m = surfaces.at(u - 0.5F, v - 0.5F, p.z(), truncation_m);
      if (distance_m > -truncation_m) {
        if (block == nullptr) block = &make(key);
        if (block->distances.empty()) block->distances.resize(kBlockVoxels);
        FusedDistance& fused = block->distances[local];
        const bool known_before = fused.known();
        const float before = fused.share();
        fused.add(distance_m / truncation_m, FusedDistance::weightOf(noise * p.z() * p.z()));
        surface_changed = surface_changed || !known_before || fused.share() != before;
      }
    }
    if (free) {
      const News news = miss(*block, local);
      changed = changed || news.any;
      surface_changed = surface_changed || news.surface;
    }
    const float inverse = view.inverse_depth(row, col);
    if (inverse < 0.0F && std::abs(1.0F + inverse * p.z()) < static_cast<float>(voxel_m) * -inverse) {
      if (block == nullptr) block = &make(key);
      countUp(block->makeSurface(local).someone);
      surface_changed = true;
    }
    Surface* surface = block == nullptr ? nullptr : block->surface(local);
    if (surface == nullptr || surface->last_hit == keyframes || p.z() >= config.free_range_m) continue;
    const float seen_m = 0.001F * static_cast<float>(view.free_mm(row, col));  // kNoReturn is farther than anything
    const bool doubted = !free && p.z() + static_cast<float>(voxel_m) < seen_m;
    const bool decides =
        surface->hits < config.confirming_keyframes &&
        (surface->views_since_hit == kViewsToConfirm || (doubted && surface->doubts_since_hit == kDoubtsUntilGone - 1));
    const Occupancy before = decides ? state(*block, local) : Occupancy::kUnknown;
    countUp(surface->views_since_hit);
    if (doubted) countUp(surface->doubts_since_hit);
    if (decides && state(*block, local) != before) surface_changed = true;
  }
  if (block == nullptr) return;
  if (changed || surface_changed) markChanged(*block, surface_changed);
  count(*block);
}

/// Nothing was at a voxel for one keyframe. @return what is served otherwise than before
VoxelMap::Impl::News VoxelMap::Impl::miss(Block& block, int local) {
  constexpr int kMissesUntilGone = 3;  // however often it was hit before
  Surface* surface = block.surface(local);
  bool was_other = false;
  if (surface != nullptr) {
    if (surface->last_hit == keyframes) return {};
    was_other = surface->misses == 0 || surface->someone > 0;
    countUp(surface->misses);
    countUp(surface->misses_since_hit);
    surface->someone = 0;
  }
  LogOdds& value = block.log_odds[local];
  const LogOdds before = value;
  change(value, missed);
  if (surface != nullptr && surface->misses_since_hit >= kMissesUntilGone) value = std::min<LogOdds>(value, 0);
  return {was_other || value != before, was_other || (surface != nullptr && value != before && before > 0)};
}

/// Whether something is so of a surface within two voxels, in the same block.
template <class Is>
bool VoxelMap::Impl::anyBeside(const Block& block, int local, const Is& is) const {
  constexpr int kReach = 2;
  const Eigen::Vector3i at(local >> (2 * kBlockBits), (local >> kBlockBits) & (kBlockSide - 1),
                           local & (kBlockSide - 1));
  const Eigen::Vector3i low = (at.array() - kReach).max(0), high = (at.array() + kReach).min(kBlockSide - 1);
  for (int x = low.x(); x <= high.x(); ++x) {
    for (int y = low.y(); y <= high.y(); ++y) {
      for (int z = low.z(); z <= high.z(); ++z) {
        const Surface* surface = block.surface((x * kBlockSide + y) * kBlockSide + z);
        if (surface != nullptr && is(*surface)) return true;
      }
    }
  }
  return false;
}

Occupancy VoxelMap::Impl::state(const Block& block, int local) const {
  // Masks miss a person now and then; they take a thing for one more seldom.
  constexpr int kHitsPerPerson = 2;
  const LogOdds value = block.log_odds[local];
  if (value == kUnknown) return Occupancy::kUnknown;
  if (value <= 0) return Occupancy::kFree;
  const Surface& surface = *block.surface(local);
  if (surface.hits <= kHitsPerPerson * surface.someone) return Occupancy::kUnknown;
  if (surface.hits < config.confirming_keyframes) {
    if (surface.misses > 0 || surface.doubts_since_hit >= kDoubtsUntilGone) return Occupancy::kUnknown;
    if (anyBeside(block, local, [](const Surface& other) { return other.someone > 0; })) return Occupancy::kUnknown;
    const auto confirmed = [&](const Surface& other) { return other.hits >= config.confirming_keyframes; };
    if (surface.views_since_hit > kViewsToConfirm && !anyBeside(block, local, confirmed)) return Occupancy::kUnknown;
  }
  const FusedDistance* distance = block.distance(local);
  if (distance != nullptr &&
      std::abs(distance->share()) * truncation_m > 0.6F * static_cast<float>(config.resolution_m)) {
    return Occupancy::kUnknown;  // noise beside the surface
  }
  return Occupancy::kOccupied;
}

Voxel VoxelMap::Impl::describe(const Eigen::Vector3i& index, const Block* block, int local) const {
  Voxel voxel;
  voxel.index = index;
  if (block == nullptr) return voxel;
  const LogOdds value = block->log_odds[local];
  voxel.state = state(*block, local);
  if (value != kUnknown) voxel.log_odds = value * kLogOddsUnit;
  const Surface* surface = block->surface(local);
  if (surface == nullptr) return voxel;
  for (int channel = 0; channel < 3; ++channel) {
    voxel.bgr[channel] = cv::saturate_cast<std::uint8_t>(surface->bgr_256ths[channel] / 256.0);
  }
  voxel.label = surface->votes.winner();
  voxel.label_share = surface->votes.share();
  voxel.last_hit = surface->last_hit;
  voxel.hits = surface->hits;
  voxel.misses = surface->misses;
  return voxel;
}

VoxelMap::VoxelMap(const VoxelMapConfig& config) {
  validateConfig(config);
  impl_ = std::make_unique<Impl>(config);
}
VoxelMap::~VoxelMap() = default;
VoxelMap::VoxelMap(VoxelMap&&) noexcept = default;
VoxelMap& VoxelMap::operator=(VoxelMap&&) noexcept = default;

void VoxelMap::integrate(const std::vector<LabelledPoint>& points, const FreeSpaceView& view,
                         const SE3& T_world_camera) {
  ++impl_->keyframes;
  impl_->insertPoints(points, T_world_camera);
  impl_->carve(view, T_world_camera);
}

Voxel VoxelMap::voxel(const Eigen::Vector3i& index) const {
  if (!inVoxelRange(index)) return impl_->describe(index, nullptr, 0);
  const VoxelKey key = voxelKey(index);
  return impl_->describe(index, impl_->find(blockKey(key)), static_cast<int>(key & (kBlockVoxels - 1)));
}

std::optional<float> VoxelMap::distance(const Eigen::Vector3i& index) const {
  if (!inVoxelRange(index)) return std::nullopt;
  const VoxelKey key = voxelKey(index);
  const Block* block = impl_->find(blockKey(key));
  const FusedDistance* fused = block == nullptr ? nullptr : block->distance(static_cast<int>(key & (kBlockVoxels - 1)));
  if (fused == nullptr) return std::nullopt;
  return fused->share() * impl_->truncation_m;
}

Voxel VoxelMap::voxelAt(const Eigen::Vector3d& point_world) const {
  return voxel(voxelIndexAt(point_world, impl_->config.resolution_m));
}

void VoxelMap::forEachKnown(const std::function<void(const Voxel&)>& visit) const {
  std::vector<VoxelKey> keys;
  keys.reserve(impl_->blocks.size());
  for (const auto& [key, block] : impl_->blocks) keys.push_back(key);
  std::sort(keys.begin(), keys.end());
  for (const VoxelKey key : keys) forEachKnownIn(key, visit);
}

void VoxelMap::forEachKnownIn(VoxelKey block_key, const std::function<void(const Voxel&)>& visit) const {
  const Block& block = impl_->blocks.at(block_key);
  for (int local = 0; local < kBlockVoxels; ++local) {
    if (block.log_odds[local] == kUnknown) continue;
    const Eigen::Vector3i index = voxelIndex((block_key << (3 * kBlockBits)) | static_cast<VoxelKey>(local));
    const Voxel voxel = impl_->describe(index, &block, local);
    if (voxel.state != Occupancy::kUnknown) visit(voxel);
  }
}

const std::vector<VoxelBlock>& VoxelMap::blocks() const { return impl_->places; }

std::uint32_t VoxelMap::revision() const { return impl_->keyframes; }

double VoxelMap::resolution() const { return impl_->config.resolution_m; }

Eigen::Vector3d VoxelMap::centre(const Eigen::Vector3i& index) const {
  return (index.cast<double>().array() + 0.5) * impl_->config.resolution_m;
}

namespace {

/// The fused distance between voxels' centres, in metres, with its slope.
struct Field {
  float distance_m = 0.0F;
  Eigen::Vector3f slope = Eigen::Vector3f::Zero();
};

}  // namespace

struct VoxelMap::SurfaceReader::Inside {
  explicit Inside(const VoxelMap::Impl& voxel_map) : map(voxel_map) {}

  /// A block that was asked for lately, with what is known of its voxels' states.
  struct Entry {
    VoxelKey key = VoxelBlock::kNone;
    const Block* block = nullptr;
    std::array<std::int8_t, kBlockVoxels> occupied;  ///< -1: not asked for yet
  };
  Entry& entry(VoxelKey key) {
    constexpr int kAxisBits = 21 - kBlockBits;
    Entry& entry = entries[(key >> (2 * kAxisBits) & 3) << 4 | (key >> kAxisBits & 3) << 2 | (key & 3)];
    if (entry.key != key) {
      entry.key = key;
      entry.block = map.find(key);
      entry.occupied.fill(-1);
    }
    return entry;
  }
  /// @return nothing where a voxel round the point knows no distance
  std::optional<Field> fieldAt(const Eigen::Vector3d& point);

  const VoxelMap::Impl& map;
  std::array<Entry, 64> entries;  ///< by the lowest two bits of the block's index
};

std::optional<Field> VoxelMap::SurfaceReader::Inside::fieldAt(const Eigen::Vector3d& point) {
  const double voxel_m = map.config.resolution_m;
  const Eigen::Vector3d at = (point / voxel_m).array() - 0.5;
  const Eigen::Vector3i low = voxelIndexAt(at, 1.0);
  if (!inVoxelRange(low) || !inVoxelRange(low + Eigen::Vector3i::Ones())) return std::nullopt;
  std::array<float, 8> value;  // of the truncation; x is the lowest bit
  const VoxelKey low_key = voxelKey(low);
  const Eigen::Vector3i in_block = low.unaryExpr([](int i) { return i & (kBlockSide - 1); });
  if (in_block.maxCoeff() < kBlockSide - 1) {
    const Block* block = entry(blockKey(low_key)).block;
    if (block == nullptr || block->distances.empty()) return std::nullopt;
    const FusedDistance* first = &block->distances[low_key & (kBlockVoxels - 1)];
    for (int corner = 0; corner < 8; ++corner) {
      const FusedDistance& fused =
          first[((corner & 1) << (2 * kBlockBits)) + ((corner >> 1 & 1) << kBlockBits) + (corner >> 2)];
      if (!fused.known()) return std::nullopt;
      value[corner] = fused.share();
    }
  } else {
    for (int corner = 0; corner < 8; ++corner) {
      const VoxelKey key = voxelKey(low + Eigen::Vector3i(corner & 1, corner >> 1 & 1, corner >> 2));
      const Block* block = entry(blockKey(key)).block;
      const FusedDistance* fused =
          block == nullptr ? nullptr : block->distance(static_cast<int>(key & (kBlockVoxels - 1)));
      if (fused == nullptr) return std::nullopt;
      value[corner] = fused->share();
    }
  }
  const Eigen::Vector3f part = (at - low.cast<double>()).cast<float>();
  const auto mix = [](float a, float b, float share) { return a + share * (b - a); };
  std::array<float, 4> along_x, step_x;
  for (int i = 0; i < 4; ++i) {
    step_x[i] = value[2 * i + 1] - value[2 * i];
    along_x[i] = value[2 * i] + part.x() * step_x[i];
  }
  const float bottom = mix(along_x[0], along_x[1], part.y()), top = mix(along_x[2], along_x[3], part.y());
  Field field;
  field.distance_m = map.truncation_m * mix(bottom, top, part.z());
  field.slope = {mix(mix(step_x[0], step_x[1], part.y()), mix(step_x[2], step_x[3], part.y()), part.z()),
                 mix(along_x[1] - along_x[0], along_x[3] - along_x[2], part.z()), top - bottom};
  field.slope *= map.truncation_m / static_cast<float>(voxel_m);
  return field;
}

VoxelMap::SurfaceReader::SurfaceReader(const VoxelMap& map) : inside_(std::make_unique<Inside>(*map.impl_)) {}
VoxelMap::SurfaceReader::~SurfaceReader() = default;

bool VoxelMap::SurfaceReader::moveOntoSurface(LabelledPoint& point, double most_m) {
  constexpr float kLeastSlope = 0.4F;  // flatter: two surfaces back to back
  const Eigen::Vector3d from = point.position();
  Eigen::Vector3d moved = from;
  for (int step = 0; step < 2; ++step) {  // the second one corrects what a bent surface leaves
    const std::optional<Field> field = inside_->fieldAt(moved);
    if (!field) break;
    const float slope = field->slope.norm();
    if (slope < kLeastSlope) break;
    if (step == 0 && std::abs(field->distance_m) / slope > most_m) return false;
    moved -= (field->slope * (field->distance_m / (slope * slope))).cast<double>();
  }
  if ((moved - from).norm() > kMost * most_m) return false;
  point.xyz_m = cv::Vec3f(static_cast<float>(moved.x()), static_cast<float>(moved.y()), static_cast<float>(moved.z()));
  return true;
}

std::optional<std::uint8_t> VoxelMap::SurfaceReader::labelAt(const Eigen::Vector3d& point_world) {
  const Eigen::Vector3i index = voxelIndexAt(point_world, inside_->map.config.resolution_m);
  if (!inVoxelRange(index)) return std::nullopt;
  const VoxelKey key = voxelKey(index);
  Inside::Entry& entry = inside_->entry(blockKey(key));
  if (entry.block == nullptr) return std::nullopt;
  const int local = static_cast<int>(key & (kBlockVoxels - 1));
  std::int8_t& occupied = entry.occupied[static_cast<std::size_t>(local)];
  if (occupied < 0) occupied = inside_->map.state(*entry.block, local) == Occupancy::kOccupied ? 1 : 0;
  if (occupied == 0) return std::nullopt;
  return entry.block->surface(local)->votes.winner();
}

void VoxelMap::forgetFarthest(const Eigen::Vector3d& place_m, std::size_t most_bytes) {
  if (impl_->bytes <= most_bytes) return;
  std::vector<std::pair<double, VoxelKey>> by_distance;
  for (const VoxelBlock& block : impl_->places) {
    if (block.key == VoxelBlock::kNone) continue;
    const Eigen::Vector3d middle = centre(blockCorner(block.key) + Eigen::Vector3i::Constant(kBlockSide / 2));
    by_distance.emplace_back((middle - place_m).squaredNorm(), block.key);
  }
  std::sort(by_distance.begin(), by_distance.end());
  while (impl_->bytes > most_bytes && !by_distance.empty()) {
    const auto found = impl_->blocks.find(by_distance.back().second);
    by_distance.pop_back();
    const Block& block = found->second;
    impl_->known -= static_cast<std::size_t>(
        std::count_if(block.log_odds.begin(), block.log_odds.end(), [](LogOdds value) { return value != kUnknown; }));
    impl_->bytes -= block.bytes;
    impl_->places[block.place] = VoxelBlock();
    impl_->free_places.push_back(block.place);
    impl_->blocks.erase(found);
  }
}

void VoxelMap::takeOver(const VoxelMap& other, const std::function<bool(const VoxelBlock&)>& wanted,
                        const std::function<std::uint32_t(std::uint32_t)>& renumber) {
  for (const VoxelBlock& from : other.impl_->places) {
    if (from.key == VoxelBlock::kNone || !wanted(from)) continue;
    Block& block = impl_->make(from.key);
    const std::uint32_t place = block.place;
    block = other.impl_->blocks.at(from.key);
    block.place = place;
    block.bytes = 0;
    impl_->count(block);
    for (Surface& surface : block.surfaces) {
      if (surface.last_hit > 0) surface.last_hit = renumber(surface.last_hit);
    }
    VoxelBlock& now = impl_->places[place];
    now.changed = renumber(from.changed);
    now.surface_changed = from.surface_changed > 0 ? now.changed : 0;
    impl_->keyframes = std::max(impl_->keyframes, now.changed);
    for (const Surface& surface : block.surfaces) impl_->keyframes = std::max(impl_->keyframes, surface.last_hit);
    impl_->known += static_cast<std::size_t>(
        std::count_if(block.log_odds.begin(), block.log_odds.end(), [](LogOdds value) { return value != kUnknown; }));
  }
}

std::size_t VoxelMap::size() const { return impl_->known; }

std::size_t VoxelMap::memoryBytes() const { return impl_->bytes; }

}  // namespace semantic_vslam
