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
#include "core/runtime/thread_priority.h"
#include "semantic_vslam/core/common/config_fields.h"
#include "semantic_vslam/core/common/error.h"
#include "semantic_vslam/core/common/log.h"

namespace semantic_vslam {
namespace {

// Keyframes come every few frames at most; a worker that is further behind than this makes tracking wait for it.
constexpr std::size_t kKeyframeQueue = 8;

}  // namespace

SparseSlam::SparseSlam(const SparseSlamConfig& config, Mode mode)
    : config_(config),
      mode_(mode),
      shared_(config.places, config.tracking),
      loops_(config, shared_),
      seeker_(config.tracking.frame, config.relocalisation),
      queue_(kKeyframeQueue, QueuePolicy::kBlock) {
  validateConfig(config_);
  if (mode_ == Mode::kBackground) worker_ = std::thread([this] { work(); });
}

SparseSlam::~SparseSlam() {
  abort_ba_ = true;
  queue_.close();
  if (worker_.joinable()) worker_.join();
}

SparseStep SparseSlam::step(const RgbdFrame& frame, const cv::Mat1b& dynamic, StageTimes& times) {
  SparseStep step;
  {
    auto timer = times.scope("tracking", frame.index);
    const TrackedFrame tracked = shared_.tracker.prepare(frame, dynamic);
    std::lock_guard<std::mutex> lock(shared_.mutex);
    step = trackLocked(tracked);
  }
  if (localization_only_) return step;
  for (const auto& id : {step.first_keyframe, step.keyframe}) {
    if (!id) continue;
    if (mode_ == Mode::kSynchronous) {
      maintain({*id, frame.index, &times});
    } else {
      ++pending_;
      if (queue_.size() > 0) abort_ba_ = true;  // the worker falls behind: a newer bundle takes over
      queue_.push({*id, frame.index, &times});
    }
  }
  return step;
}

SparseStep SparseSlam::trackLocked(const TrackedFrame& frame) {
  SparseStep step;
  const bool mapper_idle = pending_ == 0;
  const KeyframeId world = shared_.map.worldRoot();
  step.tracking = shared_.tracker.track(frame, shared_.map, mapper_idle);
  // Only a place of the world is of use where no map can grow to be joined with it.
  if (step.tracking.state == TrackingState::kOk && localization_only_ &&
      !shared_.map.isPlaced(step.tracking.reference)) {
    step.tracking.state = TrackingState::kLost;
  }
  relocaliseLocked(frame, step.tracking);
  if (step.tracking.state == TrackingState::kLost && !localization_only_) {
    step.tracking.first_frame = shared_.tracker.offerForNewMap(frame);
  }
  if (step.tracking.first_frame && !localization_only_) {
    if (!shared_.map.keyframes().empty()) {
      logWarning("lost for long: a new map is begun, to be joined at a known place");
    }
    beginMapLocked(*step.tracking.first_frame, step);
    step.tracking = shared_.tracker.track(frame, shared_.map, mapper_idle);
  }
  if (step.tracking.state == TrackingState::kOk) {
    recordLocked(frame, step);
    seekWorldLocked(frame, step);
  }
  // Where a map that is not joined lies in the world is not known, so nor is where the camera is.
  if (step.tracking.reference.valid() && !shared_.map.isPlaced(step.tracking.reference)) {
    step.tracking.state = TrackingState::kLost;
  }
  step.new_world = world.valid() && shared_.map.worldRoot() != world;
  return step;
}

void SparseSlam::beginMapLocked(TrackedFrame first, SparseStep& step) {
  step.first_keyframe = insertLocked(first);
  step.first_stamp = first.stamp;
  first.landmarks = shared_.map.keyframe(*step.first_keyframe)->landmarks;
  shared_.trajectory.add(first.stamp, first.T_camera_world, *shared_.map.keyframe(*step.first_keyframe));
  shared_.tracker.startFrom(std::move(first), *step.first_keyframe);
  dropAbandonedLocked();
}

void SparseSlam::recordLocked(const TrackedFrame& frame, SparseStep& step) {
  if (!localization_only_) {
    for (const LandmarkId id : step.tracking.visible) shared_.map.countVisible(id);
    for (const LandmarkId id : step.tracking.found) shared_.map.countFound(id);
  }
  if (step.tracking.keyframe_is_due && !localization_only_) {
    step.keyframe = insertLocked(shared_.tracker.lastFrame());
    shared_.tracker.keyframeInserted(shared_.map, *step.keyframe);
  }
  shared_.trajectory.add(frame.stamp, step.tracking.T_camera_world, *shared_.map.keyframe(shared_.tracker.reference()));
}

void SparseSlam::seekWorldLocked(const TrackedFrame& frame, SparseStep& step) {
  if (shared_.map.isPlaced(shared_.tracker.reference())) {
    seeker_.reset();
    return;
  }
  if (!config_.close_loops || localization_only_) return;
  auto closure = seeker_.seek(shared_.map, shared_.places, frame, step.tracking.T_camera_world);
  if (!closure) return;
  if (!step.keyframe) {
    step.keyframe = insertLocked(shared_.tracker.lastFrame());
    shared_.tracker.keyframeInserted(shared_.map, *step.keyframe);
  }
  closure->current = *step.keyframe;
  shared_.changeLocked([&] {
    // Moved as a whole, the new map needs no bending: landmarks of both are merged, adjustment does the rest.
    return joinTrees(shared_.map, *closure) &&
           applyLoop(shared_.map, *closure, MapSolution(), shared_.map.version(),
                     config_.tracking.frame.sensor.virtual_baseline_m, config_.loop_correction);
  });
  step.tracking.T_camera_world = shared_.tracker.lastFrame().T_camera_world;
}

void SparseSlam::relocaliseLocked(const TrackedFrame& frame, TrackingResult& result) {
  if (result.state != TrackingState::kRecentlyLost && result.state != TrackingState::kLost) return;
  std::function<bool(KeyframeId)> among;
  if (localization_only_) among = [this](KeyframeId id) { return shared_.map.isPlaced(id); };
  const auto found =
      relocalise(shared_.map, shared_.places, frame, config_.tracking.frame, config_.relocalisation, among);
  if (!found) return;
  TrackedFrame placed = frame;
  placed.T_camera_world = found->T_camera_world;
  placed.landmarks = found->landmarks;
  shared_.tracker.startFrom(std::move(placed), found->keyframe);
  if (!localization_only_) dropAbandonedLocked();
  result.state = TrackingState::kOk;
  result.T_camera_world = found->T_camera_world;
  result.covariance = found->covariance;
  result.reference = found->keyframe;
  result.matches = result.inliers = found->inliers;
}

void SparseSlam::dropAbandonedLocked() {
  const auto roots = abandonedTrees(shared_.map, shared_.tracker.reference(), config_.mapping.min_tree_keyframes);
  if (roots.empty()) return;
  for (const KeyframeId root : roots) {
    for (const KeyframeId id : shared_.map.removeTree(root)) shared_.places.remove(id);
  }
  shared_.trajectory.treesRemoved(shared_.map);
  logInfo("a map of a few keyframes, begun when lost and lost again, is dropped");
}

KeyframeId SparseSlam::insertLocked(const TrackedFrame& frame) {
  const KeyframeId id = insertKeyframe(shared_.map, frame, config_.tracking.frame.sensor, config_.mapping);
  shared_.places.add(id, *frame.features);
  return id;
}

void SparseSlam::maintain(const Upkeep& upkeep) {
  abort_ba_ = false;
  {
    auto timer = upkeep.times->scope("local_mapping", upkeep.frame);
    adjustAround(upkeep.keyframe);
  }
  if (!config_.close_loops) return;
  bool closed = false;
  {
    auto timer = upkeep.times->scope("loop_closing", upkeep.frame);
    closed = loops_.closeAt(upkeep.keyframe);
  }
  if (closed) startAdjustingAll(upkeep);
}

void SparseSlam::adjustAround(KeyframeId keyframe) {
  const SensorConfig& sensor = config_.tracking.frame.sensor;
  BaProblem problem;
  {
    std::lock_guard<std::mutex> lock(shared_.mutex);
    if (!shared_.map.keyframe(keyframe)) return;
    cullRecentLandmarks(shared_.map, keyframe, config_.mapping);
    triangulateNewLandmarks(shared_.map, keyframe, sensor, config_.triangulation);
    fuseWithNeighbours(shared_.map, keyframe, sensor.virtual_baseline_m, config_.mapping);
    problem = selectLocal(shared_.map, keyframe, sensor, config_.local_ba);
  }
  const MapSolution solution = solve(problem, config_.local_ba, &abort_ba_);
  std::lock_guard<std::mutex> lock(shared_.mutex);
  shared_.changeLocked([&] { return shared_.map.apply(solution, problem.map_version); });
  cullRedundantKeyframes(shared_.map, keyframe, shared_.tracker.reference(), sensor, config_.mapping,
                         [this](const Keyframe& removed) {
                           shared_.trajectory.keyframeRemoved(shared_.map, removed);
                           shared_.places.remove(removed.id);
                         });
}

void SparseSlam::startAdjustingAll(const Upkeep& upkeep) {
  const auto adjust = [this, upkeep](const std::atomic<bool>& abort) {
    auto timer = upkeep.times->scope("global_ba", upkeep.frame);
    loops_.adjustAll(abort);
  };
  if (mode_ == Mode::kBackground) {
    global_ba_.start(adjust);
  } else {
    adjust(std::atomic<bool>(false));
  }
}

void SparseSlam::work() {
  // It holds the map's lock for moments at low priority; at full priority tracking waits four times as long (95 % of
  // frames), since motion, tracking and decoding need both of two cores.
  lowerThreadPriority();
  while (const auto upkeep = queue_.pop()) {
    maintain(*upkeep);
    std::lock_guard<std::mutex> lock(shared_.mutex);
    --pending_;
    idle_.notify_all();
  }
}

void SparseSlam::waitForUpkeep() {
  std::unique_lock<std::mutex> lock(shared_.mutex);
  idle_.wait(lock, [this] { return pending_ == 0; });
}

void SparseSlam::finish() {
  waitForUpkeep();
  global_ba_.wait();
}

void SparseSlam::reset() {
  waitForUpkeep();
  global_ba_.cancel();
  std::lock_guard<std::mutex> lock(shared_.mutex);
  shared_.map.clear();
  shared_.places.clear();
  loops_.resetLocked();
  seeker_.reset();
  shared_.trajectory.clear();
  shared_.tracker.reset();
}

void SparseSlam::startTimeAnew() {
  std::lock_guard<std::mutex> lock(shared_.mutex);
  seeker_.reset();
  shared_.trajectory.clear();
  if (shared_.map.keyframes().empty()) {
    shared_.tracker.reset();
  } else {
    shared_.tracker.awaitRelocalisation();
  }
}

std::size_t SparseSlam::saveMap(const std::string& path) const {
  // Written from a copy: a slow disk must not hold up tracking.
  const Map map = [this] {
    std::lock_guard<std::mutex> lock(shared_.mutex);
    return shared_.map;
  }();
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
  waitForUpkeep();
  global_ba_.cancel();
  std::lock_guard<std::mutex> lock(shared_.mutex);
  // A bundle of the map before must not fit the new one.
  while (saved.map.version() <= shared_.map.version()) saved.map.bumpVersion();
  shared_.map = std::move(saved.map);
  shared_.places = std::move(saved.places);
  loops_.resetLocked();
  seeker_.reset();
  shared_.trajectory.clear();
  shared_.tracker.awaitRelocalisation();
}

std::vector<TimedPose> SparseSlam::trajectory(std::size_t most) const {
  std::lock_guard<std::mutex> lock(shared_.mutex);
  return shared_.trajectory.poses(shared_.map, most);
}

std::vector<KeyframePose> SparseSlam::keyframePoses() const {
  std::lock_guard<std::mutex> lock(shared_.mutex);
  std::vector<KeyframePose> poses;
  const auto roots = shared_.map.roots();
  for (const auto& [id, keyframe] : shared_.map.keyframes()) {
    if (roots.at(id) == shared_.map.worldRoot())
      poses.push_back({id, keyframe.stamp, keyframe.T_camera_world.inverse()});
  }
  return poses;
}

bool SparseSlam::holds(KeyframeId keyframe) const {
  std::lock_guard<std::mutex> lock(shared_.mutex);
  return shared_.map.keyframe(keyframe) != nullptr;
}

std::size_t SparseSlam::keyframeCount() const {
  std::lock_guard<std::mutex> lock(shared_.mutex);
  return shared_.map.keyframes().size();
}

std::size_t SparseSlam::landmarkCount() const {
  std::lock_guard<std::mutex> lock(shared_.mutex);
  return shared_.map.landmarks().size();
}

std::vector<Eigen::Vector3d> SparseSlam::landmarkPositions() const {
  std::lock_guard<std::mutex> lock(shared_.mutex);
  std::vector<Eigen::Vector3d> positions;
  positions.reserve(shared_.map.landmarks().size());
  const auto roots = shared_.map.roots();
  for (const auto& [id, landmark] : shared_.map.landmarks()) {
    static_cast<void>(id);
    if (roots.at(landmark.reference_keyframe) == shared_.map.worldRoot()) positions.push_back(landmark.position_world);
  }
  return positions;
}

}  // namespace semantic_vslam
