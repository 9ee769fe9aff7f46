// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/tracking_stage.h"

#include <string>
#include <utility>

#include "core/common/stamp_order.h"
#include "core/pipeline/sparse_slam.h"
#include "semantic_vslam/core/common/config_fields.h"
#include "semantic_vslam/core/common/log.h"

namespace semantic_vslam {
namespace {

// While there is no map, labels that the motion stage carries on are good for this long: k2 follows k1 at once, and
// where it does not fit people have moved on after half a second.
constexpr double kFirstLabelsHoldS = 0.5;

}  // namespace

struct TrackingStage::Inside {
  Inside(const SparseSlamConfig& slam_config, const TrackingWaits& tracking_waits, const RemovalConfig& removal_config,
         std::uint32_t first_map_id)
      : waits(tracking_waits), removal(removal_config), slam(slam_config), map_id(first_map_id) {
    validateConfig(waits);
    validateConfig(removal);
  }

  void beginMap() {
    ++map_id;
    origin = 0;
    has_candidate = false;
    first_wanted.reset();
  }
  /// Whether somebody has told where people are in a frame; labels say nothing without the list of classes.
  bool hasLabels(const TrackingInput& input) const {
    const std::optional<Stamp>& carried = input.motion.labels;
    return (input.labels && label_set.size() > 1) ||
           (carried && secondsBetween(*carried, input.frame.stamp) < kFirstLabelsHoldS);
  }
  /// Whether nobody has, though the start needs it.
  bool lacksLabels(const TrackingInput& input) const {
    if (!input.network_runs || slam.keyframeCount() > 0 || hasLabels(input)) return false;
    return !first_wanted || secondsBetween(*first_wanted, input.frame.stamp) < waits.init_wait_s;
  }

  std::optional<FramePlace> placeOf(const TrackingResult& tracking, Stamp stamp) const {
    const Keyframe* reference = slam.map().keyframe(tracking.reference);
    if (reference == nullptr) return std::nullopt;
    return FramePlace{stamp, map_id, reference->id, reference->T_camera_world * tracking.T_camera_world.inverse()};
  }

  const TrackingWaits waits;
  const RemovalConfig removal;
  SparseSlam slam;
  LabelSet label_set;
  StampOrder order;
  std::uint32_t map_id, origin = 0;   ///< of MapSnapshot
  bool has_candidate = false;         ///< the last frame may be k1
  std::optional<Stamp> first_wanted;  ///< first frame that waited for labels since there was no map
  std::shared_ptr<const MapSnapshot> snapshot = std::make_shared<MapSnapshot>();
};

TrackingStage::TrackingStage(const SparseSlamConfig& config, const TrackingWaits& waits, const RemovalConfig& removal,
                             std::uint32_t first_map_id)
    : inside_(std::make_unique<Inside>(config, waits, removal, first_map_id)) {}
TrackingStage::~TrackingStage() = default;
TrackingStage::TrackingStage(TrackingStage&&) noexcept = default;

bool TrackingStage::accepts(Stamp stamp, std::uint32_t recording, bool localization_only) {
  switch (inside_->order.of(stamp, recording)) {
    case StampOrder::Arrival::kNext: return true;
    case StampOrder::Arrival::kOutOfOrder: return false;
    case StampOrder::Arrival::kPlayedAgain:
      if (!localization_only) {
        logWarning("the clock went back, as when a recording is played again: map and trajectory are dropped");
        reset();
        return true;
      }
      break;
    case StampOrder::Arrival::kSetBack: break;
  }
  logWarning("stamps went back: the map stays, the trajectory begins anew");
  inside_->slam.startTimeAnew();
  inside_->has_candidate = false;
  inside_->first_wanted.reset();
  return true;
}

bool TrackingStage::wantsLabels(const TrackingInput& input) {
  if (inside_->has_candidate) return false;
  if (!inside_->lacksLabels(input)) {
    const bool in_vain = input.network_runs && !hasMap() && inside_->first_wanted && !inside_->hasLabels(input);
    if (in_vain) logWarning("no labels within init_wait_s: starting without, people who stand still may be mapped");
    return false;
  }
  if (!inside_->first_wanted) inside_->first_wanted = input.frame.stamp;
  return true;
}

TrackingStage::Prepared TrackingStage::prepare(const TrackingInput& input) const {
  Prepared prepared;
  prepared.removed = removedPixels(input.motion, input.labels ? input.labels->labels : cv::Mat1b(), inside_->label_set,
                                   inside_->removal);
  prepared.frame = std::make_shared<TrackedFrame>(inside_->slam.prepare(input.frame, prepared.removed));
  return prepared;
}

TrackingOutput TrackingStage::track(const TrackingInput& input, const Prepared& prepared, const TrackOptions& options,
                                    const TrackingWishes& wishes) {
  const bool may_be_k1 = !inside_->lacksLabels(input);
  const SparseStep step = inside_->slam.track(*prepared.frame, options);
  if (step.new_world) {
    ++inside_->map_id;
    inside_->origin = 0;
  }
  inside_->has_candidate = step.tracking.state == TrackingState::kInitialising;
  if (inside_->hasLabels(input) || !inside_->has_candidate) inside_->first_wanted.reset();
  if (inside_->has_candidate && !may_be_k1) {
    inside_->slam.reset();  // k2 did not fit and may show people: it must not become k1 in its turn
    inside_->has_candidate = false;
  }
  TrackingOutput output;
  output.tracking = step.tracking;
  output.removed = prepared.removed;
  output.is_keyframe = step.keyframe.has_value();
  output.new_world = step.new_world;
  if (step.first_keyframe) output.keyframes.push_back({*step.first_keyframe, inside_->map_id, step.first_stamp});
  if (step.keyframe) output.keyframes.push_back({*step.keyframe, inside_->map_id, input.frame.stamp});
  if (output.posed() && !step.keyframe && !options.localization_only) {
    output.place = inside_->placeOf(step.tracking, input.frame.stamp);
  }
  output.map = snapshot();
  if (wishes.path > 0) output.path = inside_->slam.trajectory(wishes.path);
  if (wishes.points && !output.keyframes.empty()) output.points = inside_->slam.landmarkPositions();
  return output;
}

bool TrackingStage::maintain(KeyframeId keyframe, std::uint64_t frame, StageTimes& times, const Alone& alone,
                             const AbortFlag& abort) {
  return inside_->slam.maintain(keyframe, frame, times, alone, abort);
}

void TrackingStage::adjustAll(std::uint64_t frame, StageTimes& times, const Alone& alone, const AbortFlag& abort) {
  inside_->slam.adjustAll(frame, times, alone, abort);
}

void TrackingStage::take(const LabelSet& label_set) { inside_->label_set = label_set; }

void TrackingStage::reset() {
  inside_->slam.reset();
  inside_->beginMap();
}

std::shared_ptr<SavedMap> TrackingStage::readMap(const std::string& path) const {
  return std::make_shared<SavedMap>(inside_->slam.readMap(path));
}

void TrackingStage::loadMap(SavedMap& saved) {
  inside_->slam.loadMap(std::move(saved));
  inside_->beginMap();
  inside_->origin = inside_->slam.map().origin().map_id;
}

Map TrackingStage::copyMap() const {
  Map map = inside_->slam.map();
  map.setOrigin({inside_->map_id, std::nullopt});
  return map;
}

std::uint32_t TrackingStage::loadedFrom() const { return inside_->origin; }

bool TrackingStage::hasMap() const { return inside_->slam.keyframeCount() > 0; }

std::shared_ptr<const MapSnapshot> TrackingStage::snapshot() {
  const SparseSlam& slam = inside_->slam;
  const MapSnapshot& last = *inside_->snapshot;
  if (last.map_id == inside_->map_id && last.version == slam.posesVersion()) return inside_->snapshot;
  auto now = std::make_shared<MapSnapshot>();
  now->map_id = inside_->map_id;
  now->origin = inside_->origin;
  now->version = slam.posesVersion();
  now->poses = slam.keyframePoses();
  auto placed = now->poses.begin();  // both in the order of ids
  for (const auto& entry : slam.map().keyframes()) {
    if (placed != now->poses.end() && placed->keyframe == entry.first) {
      ++placed;
    } else {
      now->unplaced.push_back(entry.first);
    }
  }
  now->landmarks = slam.landmarkCount();
  now->loops = slam.loopCount();
  return inside_->snapshot = std::move(now);
}

const SparseSlam& TrackingStage::slam() const { return inside_->slam; }

}  // namespace semantic_vslam
