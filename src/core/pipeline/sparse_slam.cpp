// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/sparse_slam.h"

#include <functional>
#include <utility>

#include "core/loop/loop_corrector.h"
#include "core/map/map_file.h"
#include "core/mapping/ba_selection.h"
#include "core/mapping/landmark_triangulation.h"
#include "core/mapping/map_maintenance.h"
#include "core/optimization/bundle_adjustment.h"
#include "semantic_vslam/core/common/config_fields.h"
#include "semantic_vslam/core/common/error.h"
#include "semantic_vslam/core/common/log.h"

namespace semantic_vslam {

SparseSlam::SparseSlam(const SparseSlamConfig& config)
    : config_(config),
      state_(config.places, config.tracking),
      loops_(config, state_),
      seeker_(config.tracking.frame, config.relocalisation) {
  validateConfig(config_);
}

TrackedFrame SparseSlam::prepare(const RgbdFrame& frame, const cv::Mat1b& dynamic) const {
  return state_.tracker.prepare(frame, dynamic);
}

SparseStep SparseSlam::step(const RgbdFrame& frame, const cv::Mat1b& dynamic, StageTimes& times,
                            bool localization_only) {
  const Alone at_once = [](const std::function<void()>& use) { use(); };
  const AbortFlag never{false};
  SparseStep step;
  {
    auto timer = times.scope("tracking", frame.index);
    step = track(prepare(frame, dynamic), {localization_only, true});
  }
  for (const auto& keyframe : {step.first_keyframe, step.keyframe}) {
    if (keyframe && maintain(*keyframe, frame.index, times, at_once, never)) {
      adjustAll(frame.index, times, at_once, never);
    }
  }
  return step;
}

/// Between the first and the last keyframe.
static double secondsMapped(const Map& map) {
  if (map.keyframes().empty()) return 0.0;
  return std::abs(secondsBetween(map.keyframes().begin()->second.stamp, map.keyframes().rbegin()->second.stamp));
}

SparseStep SparseSlam::track(const TrackedFrame& frame, const TrackOptions& options) {
  SparseStep step;
  const KeyframeId world = state_.map.worldRoot();
  step.tracking = state_.tracker.track(frame, state_.map, options.upkeep_is_done);
  // Only a place of the world is of use where no map can grow to be joined with it.
  if (step.tracking.state == TrackingState::kOk && options.localization_only &&
      !state_.map.isPlaced(step.tracking.reference)) {
    step.tracking.state = TrackingState::kLost;
  }
  findAgain(frame, options, step.tracking);
  if (step.tracking.keyframe_is_due && !options.localization_only) confirmPlace(frame, step.tracking);
  if (step.tracking.state == TrackingState::kLost && !options.localization_only) {
    step.tracking.first_frame = state_.tracker.offerForNewMap(frame, secondsMapped(state_.map));
  }
  if (step.tracking.first_frame && !options.localization_only) {
    if (!state_.map.keyframes().empty()) {
      logWarning("lost for long: a new map is begun, to be joined at a known place");
    }
    beginMap(*step.tracking.first_frame, step);
    step.tracking = state_.tracker.track(frame, state_.map, options.upkeep_is_done);
  }
  if (step.tracking.state == TrackingState::kOk) {
    record(frame, options, step);
    if (!options.localization_only) seekWorld(frame, step);
  }
  // Where a map that is not joined lies in the world is not known, so nor is where the camera is.
  if (step.tracking.reference.valid() && !state_.map.isPlaced(step.tracking.reference)) {
    step.tracking.state = TrackingState::kLost;
  }
  step.new_world = world.valid() && state_.map.worldRoot() != world;
  return step;
}

void SparseSlam::beginMap(TrackedFrame first, SparseStep& step) {
  step.first_keyframe = insert(first);
  step.first_stamp = first.stamp;
  first.landmarks = state_.map.keyframe(*step.first_keyframe)->landmarks;
  state_.trajectory.add(first.stamp, first.T_camera_world, *state_.map.keyframe(*step.first_keyframe));
  state_.tracker.startFrom(std::move(first), *step.first_keyframe);
  dropAbandoned();
}

void SparseSlam::record(const TrackedFrame& frame, const TrackOptions& options, SparseStep& step) {
  if (!options.localization_only) {
    for (const LandmarkId id : step.tracking.visible) state_.map.countVisible(id);
    for (const LandmarkId id : step.tracking.found) state_.map.countFound(id);
    if (step.tracking.keyframe_is_due) insertLast(step);
  }
  state_.trajectory.add(frame.stamp, step.tracking.T_camera_world, *state_.map.keyframe(state_.tracker.reference()));
}

void SparseSlam::seekWorld(const TrackedFrame& frame, SparseStep& step) {
  if (state_.map.isPlaced(state_.tracker.reference())) {
    seeker_.reset();
    return;
  }
  if (!config_.close_loops) return;
  auto closure = seeker_.seek(state_.map, state_.places, frame, step.tracking.T_camera_world);
  if (!closure) return;
  if (!step.keyframe) insertLast(step);
  closure->current = *step.keyframe;
  state_.change([&] {
    // Moved as a whole, the new map needs no bending: landmarks of both are merged, adjustment does the rest.
    return joinTrees(state_.map, *closure) &&
           applyLoop(state_.map, *closure, MapSolution(), state_.map.version(),
                     config_.tracking.frame.sensor.virtual_baseline_m, config_.loop_correction);
  });
  step.tracking.T_camera_world = state_.tracker.lastFrame().T_camera_world;
}

void SparseSlam::findAgain(const TrackedFrame& frame, const TrackOptions& options, TrackingResult& result) {
  if (result.state != TrackingState::kRecentlyLost && result.state != TrackingState::kLost) return;
  std::function<bool(KeyframeId)> among;
  if (options.localization_only) among = [this](KeyframeId id) { return state_.map.isPlaced(id); };
  const auto found =
      relocalise(state_.map, state_.places, frame, config_.tracking.frame, config_.relocalisation, among);
  if (!found) return;
  startAt(*found, frame, result);
  if (!options.localization_only) dropAbandoned();
}

void SparseSlam::confirmPlace(const TrackedFrame& frame, TrackingResult& result) {
  // True poses of walk_xyz at 3 Hz find more than a tenth of what they should see, those that are off by 5 cm or more a
  // twentieth: the wrong ones among chance matches.
  constexpr double kSureShare = 0.1;
  constexpr double kSamePlaceM = 0.05;  // as far as two poses of one frame lie apart that fit the map as well
  if (static_cast<double>(result.inliers) >= kSureShare * static_cast<double>(result.visible.size())) return;
  const KeyframeId tree = state_.map.rootOf(result.reference);
  const auto found = relocalise(state_.map, state_.places, frame, config_.tracking.frame, config_.relocalisation,
                                [&](KeyframeId id) { return state_.map.rootOf(id) == tree; });
  if (!found || found->inliers <= result.inliers) return;
  const SE3 T_found_tracked = found->T_camera_world * result.T_camera_world.inverse();
  if (T_found_tracked.translation().norm() < kSamePlaceM) return;
  startAt(*found, frame, result);
  result.keyframe_is_due = false;
  result.visible.clear();
  result.found.clear();
}

/// Goes on from where a frame was recognised.
void SparseSlam::startAt(const RelocalisationResult& place, const TrackedFrame& frame, TrackingResult& result) {
  TrackedFrame placed = frame;
  placed.T_camera_world = place.T_camera_world;
  placed.landmarks = place.landmarks;
  state_.tracker.startFrom(std::move(placed), place.keyframe);
  result.state = TrackingState::kOk;
  result.T_camera_world = place.T_camera_world;
  result.covariance = place.covariance;
  result.relocalised = true;
  result.last_step.reset();  // it led elsewhere, if there was one
  result.reference = place.keyframe;
  result.matches = result.inliers = place.inliers;
}

void SparseSlam::dropAbandoned() {
  const auto roots = abandonedTrees(state_.map, state_.tracker.reference(), config_.sparse_map.min_tree_keyframes,
                                    config_.sparse_map.min_tree_s);
  if (roots.empty()) return;
  for (const KeyframeId root : roots) {
    for (const KeyframeId id : state_.map.removeTree(root)) state_.places.remove(id);
  }
  state_.trajectory.treesRemoved(state_.map);
  ++state_.poses_version;
  logInfo("a map of a few keyframes, begun when lost and lost again, is dropped");
}

KeyframeId SparseSlam::insert(const TrackedFrame& frame) {
  const KeyframeId id = insertKeyframe(state_.map, frame, config_.tracking.frame.sensor, config_.sparse_map);
  state_.places.add(id, *frame.features);
  ++state_.poses_version;
  return id;
}

/// Makes a keyframe of the frame just tracked.
void SparseSlam::insertLast(SparseStep& step) {
  step.keyframe = insert(state_.tracker.lastFrame());
  state_.tracker.keyframeInserted(state_.map, *step.keyframe);
  const auto expected = static_cast<double>(step.tracking.visible.size());
  if (expected > 0.0) loops_.noteKeyframe(*step.keyframe, step.tracking.inliers / expected);
}

bool SparseSlam::maintain(KeyframeId keyframe, std::uint64_t frame, StageTimes& times, const Alone& alone,
                          const AbortFlag& abort) {
  {
    auto timer = times.scope("local_mapping", frame);
    adjustAround(keyframe, alone, abort);
  }
  if (!config_.close_loops) return false;
  auto timer = times.scope("loop_closing", frame);
  return loops_.closeAt(keyframe, alone);
}

void SparseSlam::adjustAround(KeyframeId keyframe, const Alone& alone, const AbortFlag& abort) {
  const SensorConfig& sensor = config_.tracking.frame.sensor;
  std::optional<BaProblem> problem;
  alone([&] {
    if (!state_.map.keyframe(keyframe)) return;
    cullRecentLandmarks(state_.map, keyframe, config_.sparse_map);
    triangulateNewLandmarks(state_.map, keyframe, sensor, config_.triangulation);
    fuseWithNeighbours(state_.map, keyframe, sensor.virtual_baseline_m, config_.sparse_map);
    problem = selectLocal(state_.map, keyframe, sensor, config_.bundle_adjustment);
  });
  if (!problem) return;
  const MapSolution solution = solve(*problem, config_.bundle_adjustment, &abort);
  alone([&] {
    state_.change([&] { return state_.map.apply(solution, problem->map_version); });
    cullRedundantKeyframes(state_.map, keyframe, state_.tracker.reference(), sensor, config_.sparse_map,
                           [this](const Keyframe& removed) {
                             state_.trajectory.keyframeRemoved(state_.map, removed);
                             state_.places.remove(removed.id);
                             ++state_.poses_version;
                           });
  });
}

void SparseSlam::adjustAll(std::uint64_t frame, StageTimes& times, const Alone& alone, const AbortFlag& abort) {
  auto timer = times.scope("global_ba", frame);
  loops_.adjustAll(alone, abort);
}

void SparseSlam::reset() {
  state_.map.clear();
  state_.places.clear();
  loops_.reset();
  seeker_.reset();
  state_.trajectory.clear();
  state_.tracker.reset();
  ++state_.poses_version;
}

void SparseSlam::startTimeAnew() {
  seeker_.reset();
  state_.trajectory.clear();
  if (state_.map.keyframes().empty()) {
    state_.tracker.reset();
  } else {
    state_.tracker.awaitRelocalisation();
  }
}

std::size_t SparseSlam::saveMap(const std::string& path, const Map& map) {
  if (map.keyframes().empty()) throw Error("there is no map to save yet; " + path + " is not touched");
  semantic_vslam::saveMap(path, map);
  return map.keyframes().size();
}

SavedMap SparseSlam::readMap(const std::string& path) const {
  SavedMap saved{Map(), PlaceIndex(config_.places)};
  semantic_vslam::loadMap(path, saved.map);
  indexKeyframes(saved.map, saved.places);
  return saved;
}

void SparseSlam::loadMap(SavedMap saved) {
  // A bundle of the map before must not fit the new one.
  while (saved.map.version() <= state_.map.version()) saved.map.bumpVersion();
  state_.map = std::move(saved.map);
  state_.places = std::move(saved.places);
  loops_.reset();
  seeker_.reset();
  state_.trajectory.clear();
  state_.tracker.awaitRelocalisation();
  ++state_.poses_version;
}

std::vector<TimedPose> SparseSlam::trajectory(std::size_t most) const {
  return state_.trajectory.poses(state_.map, most);
}

std::vector<KeyframePose> SparseSlam::keyframePoses() const {
  std::vector<KeyframePose> poses;
  const auto roots = state_.map.roots();
  for (const auto& [id, keyframe] : state_.map.keyframes()) {
    if (roots.at(id) == state_.map.worldRoot()) {
      poses.push_back({id, keyframe.stamp, keyframe.T_camera_world.inverse()});
    }
  }
  return poses;
}

std::vector<Eigen::Vector3d> SparseSlam::landmarkPositions() const {
  std::vector<Eigen::Vector3d> positions;
  positions.reserve(state_.map.landmarks().size());
  const auto roots = state_.map.roots();
  for (const auto& entry : state_.map.landmarks()) {
    const Landmark& landmark = entry.second;
    if (roots.at(landmark.reference_keyframe) == state_.map.worldRoot()) positions.push_back(landmark.position_world);
  }
  return positions;
}

}  // namespace semantic_vslam
