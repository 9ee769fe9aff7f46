// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "semantic_vslam/core/pipeline/sparse_slam.h"

#include <utility>

#include "semantic_vslam/core/common/config_fields.h"
#include "semantic_vslam/core/common/log.h"
#include "semantic_vslam/core/io/map_file.h"

namespace semantic_vslam {
namespace {

// Keyframes come every few frames at most; a worker that is further behind than this makes tracking wait for it.
constexpr std::size_t kKeyframeQueue = 8;

// In a new map, every so many frames are looked up in the old one: it takes as long as tracking does.
constexpr std::uint64_t kSeekEvery = 3;

ClosedLoop recordOf(const Map& map, const LoopClosure& closure) {
  return {map.keyframe(closure.current)->stamp, map.keyframe(closure.matched)->stamp, closure.T_current_matched};
}

}  // namespace

SparseSlam::SparseSlam(const SparseSlamConfig& config, Mode mode)
    : config_(config),
      mode_(mode),
      places_(config.places),
      loops_(config.loop_detection, config.tracking.frame),
      tracker_(config.tracking),
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
    const TrackedFrame tracked = tracker_.prepare(frame, dynamic);
    std::lock_guard<std::mutex> lock(mutex_);
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
  step.tracking = tracker_.track(frame, map_, mapper_idle);
  relocaliseLocked(frame, step.tracking);
  if (step.tracking.state == TrackingState::kLost && !localization_only_) {
    step.tracking.first_frame = tracker_.offerForNewMap(frame);
  }
  if (step.tracking.first_frame) {
    if (!map_.keyframes().empty()) logWarning("lost for long: a new map is begun, to be joined at a known place");
    beginMapLocked(*step.tracking.first_frame, step);
    step.tracking = tracker_.track(frame, map_, mapper_idle);
  }
  if (step.tracking.state == TrackingState::kOk) {
    recordLocked(frame, step);
    seekWorldLocked(frame, step);
  }
  // Where a map that is not joined lies in the world is not known, so nor is where the camera is.
  if (step.tracking.reference.valid() && !map_.isPlaced(step.tracking.reference)) {
    step.tracking.state = TrackingState::kLost;
  }
  return step;
}

void SparseSlam::beginMapLocked(TrackedFrame first, SparseStep& step) {
  step.first_keyframe = insertLocked(first);
  step.first_stamp = first.stamp;
  first.landmarks = map_.keyframe(*step.first_keyframe)->landmarks;
  trajectory_.add(first.stamp, first.T_camera_world, *map_.keyframe(*step.first_keyframe));
  tracker_.startFrom(std::move(first), *step.first_keyframe);
}

void SparseSlam::recordLocked(const TrackedFrame& frame, SparseStep& step) {
  if (!localization_only_) {
    for (const LandmarkId id : step.tracking.visible) map_.countVisible(id);
    for (const LandmarkId id : step.tracking.found) map_.countFound(id);
  }
  if (step.tracking.keyframe_is_due && !localization_only_) {
    step.keyframe = insertLocked(tracker_.lastFrame());
    tracker_.keyframeInserted(map_, *step.keyframe);
  }
  trajectory_.add(frame.stamp, step.tracking.T_camera_world, *map_.keyframe(tracker_.reference()));
}

void SparseSlam::seekWorldLocked(const TrackedFrame& frame, SparseStep& step) {
  if (map_.isPlaced(tracker_.reference())) {
    join_evidence_.reset();
    return;
  }
  if (!config_.close_loops || localization_only_ || frame.index % kSeekEvery != 0) return;
  const auto found = relocalise(map_, places_, frame, config_.tracking.frame, config_.relocalisation,
                                [this](KeyframeId id) { return map_.isPlaced(id); });
  if (!found) return;
  const bool settled = join_evidence_.add(step.tracking.T_camera_world.inverse(), found->T_camera_world.inverse());
  if (!settled) return;
  if (!step.keyframe) {
    step.keyframe = insertLocked(tracker_.lastFrame());
    tracker_.keyframeInserted(map_, *step.keyframe);
  }
  LoopClosure closure;
  closure.current = *step.keyframe;
  closure.matched = found->keyframe;
  closure.T_current_world = found->T_camera_world;
  closure.T_current_matched = found->T_camera_world * map_.keyframe(found->keyframe)->T_camera_world.inverse();
  closure.landmarks = found->landmarks;
  changeLocked([&] {
    // Moved as a whole, the new map needs no bending: landmarks of both are merged, adjustment does the rest.
    return joinTrees(map_, closure) &&
           applyLoop(map_, closure, MapSolution(), map_.version(), config_.tracking.frame.sensor.virtual_baseline_m,
                     config_.loop_correction);
  });
  step.tracking.T_camera_world = tracker_.lastFrame().T_camera_world;
  logInfo("the new map is joined with the old one");
}

void SparseSlam::relocaliseLocked(const TrackedFrame& frame, TrackingResult& result) {
  if (result.state != TrackingState::kRecentlyLost && result.state != TrackingState::kLost) return;
  const auto found = relocalise(map_, places_, frame, config_.tracking.frame, config_.relocalisation);
  if (!found) return;
  TrackedFrame placed = frame;
  placed.T_camera_world = found->T_camera_world;
  placed.landmarks = found->landmarks;
  tracker_.startFrom(std::move(placed), found->keyframe);
  result.state = TrackingState::kOk;
  result.T_camera_world = found->T_camera_world;
  result.covariance = found->covariance;
  result.reference = found->keyframe;
  result.matches = result.inliers = found->inliers;
}

KeyframeId SparseSlam::insertLocked(const TrackedFrame& frame) {
  const KeyframeId id = insertKeyframe(map_, frame, config_.tracking.frame.sensor, config_.mapping);
  places_.add(id, *frame.features);
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
    closed = closeLoop(upkeep.keyframe);
  }
  if (closed) startAdjustingAll(upkeep);
}

template <class Change>
bool SparseSlam::changeLocked(const Change& change) {
  const Keyframe* reference = map_.keyframe(tracker_.reference());
  const SE3 T_reference_world_before = reference ? reference->T_camera_world : SE3::Identity();
  if (!change()) return false;
  reference = map_.keyframe(tracker_.reference());
  if (reference) tracker_.followReference(T_reference_world_before, reference->T_camera_world);
  return true;
}

void SparseSlam::adjustAround(KeyframeId keyframe) {
  const SensorConfig& sensor = config_.tracking.frame.sensor;
  BaProblem problem;
  {
    std::lock_guard<std::mutex> lock(mutex_);
    if (!map_.keyframe(keyframe)) return;
    cullRecentLandmarks(map_, keyframe, config_.mapping);
    triangulateNewLandmarks(map_, keyframe, sensor, config_.triangulation);
    fuseWithNeighbours(map_, keyframe, sensor.virtual_baseline_m, config_.mapping);
    problem = selectLocal(map_, keyframe, sensor, config_.local_ba);
  }
  const MapSolution solution = solve(problem, config_.local_ba, &abort_ba_);
  std::lock_guard<std::mutex> lock(mutex_);
  changeLocked([&] { return map_.apply(solution, problem.map_version); });
  cullRedundantKeyframes(map_, keyframe, tracker_.reference(), sensor, config_.mapping,
                         [this](const Keyframe& removed) {
                           trajectory_.keyframeRemoved(map_, removed);
                           places_.remove(removed.id);
                         });
}

bool SparseSlam::closeLoop(KeyframeId keyframe) {
  std::optional<LoopClosure> closure;
  PoseGraphProblem graph;
  {
    std::lock_guard<std::mutex> lock(mutex_);
    if (!map_.keyframe(keyframe)) return false;
    closure = loops_.detect(map_, places_, keyframe);
    if (!closure) return false;
    if (changeLocked([&] { return joinTrees(map_, *closure); })) logInfo("the new map is joined with the old one");
    graph = selectLoop(map_, *closure, config_.loop_correction);
  }
  const MapSolution solution = solve(graph, config_.loop_correction.graph, nullptr);
  {
    std::lock_guard<std::mutex> lock(mutex_);
    const bool applied = changeLocked([&] {
      return applyLoop(map_, *closure, solution, graph.map_version, config_.tracking.frame.sensor.virtual_baseline_m,
                       config_.loop_correction);
    });
    loops_.reset();
    if (!applied) return false;
    closed_loops_.push_back(recordOf(map_, *closure));
  }
  logInfo("loop closed: this place was seen before");
  return true;
}

void SparseSlam::startAdjustingAll(const Upkeep& upkeep) {
  const auto adjust = [this, upkeep](const std::atomic<bool>& abort) {
    auto timer = upkeep.times->scope("global_ba", upkeep.frame);
    adjustAll(abort);
  };
  if (mode_ == Mode::kBackground) {
    global_ba_.start(adjust);
  } else {
    adjust(std::atomic<bool>(false));
  }
}

void SparseSlam::adjustAll(const std::atomic<bool>& abort) {
  BaProblem problem;
  {
    std::lock_guard<std::mutex> lock(mutex_);
    problem = selectGlobal(map_, config_.tracking.frame.sensor);
  }
  MapSolution solution = solve(problem, config_.local_ba, &abort);
  if (abort) return;  // the loop that aborted it starts another one
  std::lock_guard<std::mutex> lock(mutex_);
  carryAlong(map_, solution);
  // The new version refuses a local adjustment of the map as it was before.
  if (changeLocked([&] { return map_.apply(solution, problem.map_version); })) map_.bumpVersion();
}

void SparseSlam::work() {
  while (const auto upkeep = queue_.pop()) {
    maintain(*upkeep);
    std::lock_guard<std::mutex> lock(mutex_);
    --pending_;
    idle_.notify_all();
  }
}

void SparseSlam::waitForUpkeep() {
  std::unique_lock<std::mutex> lock(mutex_);
  idle_.wait(lock, [this] { return pending_ == 0; });
}

void SparseSlam::finish() {
  waitForUpkeep();
  global_ba_.wait();
}

void SparseSlam::reset() {
  waitForUpkeep();
  global_ba_.cancel();
  std::lock_guard<std::mutex> lock(mutex_);
  map_.clear();
  places_.clear();
  loops_.reset();
  closed_loops_.clear();
  join_evidence_.reset();
  trajectory_.clear();
  tracker_.reset();
}

void SparseSlam::saveMap(const std::string& path) const {
  std::lock_guard<std::mutex> lock(mutex_);
  semantic_vslam::saveMap(path, map_);
}

void SparseSlam::loadMap(const std::string& path) {
  waitForUpkeep();
  global_ba_.cancel();
  Map loaded;
  semantic_vslam::loadMap(path, loaded);
  std::lock_guard<std::mutex> lock(mutex_);
  map_ = std::move(loaded);
  places_.clear();
  indexKeyframes(map_, places_);
  loops_.reset();
  join_evidence_.reset();
  trajectory_.clear();
  tracker_.awaitRelocalisation();
}

std::vector<TimedPose> SparseSlam::trajectory() const {
  std::lock_guard<std::mutex> lock(mutex_);
  return trajectory_.poses(map_);
}

std::vector<KeyframePose> SparseSlam::keyframePoses() const {
  std::lock_guard<std::mutex> lock(mutex_);
  std::vector<KeyframePose> poses;
  for (const auto& [id, keyframe] : map_.keyframes()) {
    if (map_.isPlaced(id)) poses.push_back({id, keyframe.stamp, keyframe.T_camera_world.inverse()});
  }
  return poses;
}

bool SparseSlam::awaitsPlace(KeyframeId keyframe) const {
  std::lock_guard<std::mutex> lock(mutex_);
  return map_.keyframe(keyframe) != nullptr && !map_.isPlaced(keyframe);
}

std::size_t SparseSlam::keyframeCount() const {
  std::lock_guard<std::mutex> lock(mutex_);
  return map_.keyframes().size();
}

std::size_t SparseSlam::landmarkCount() const {
  std::lock_guard<std::mutex> lock(mutex_);
  return map_.landmarks().size();
}

std::size_t SparseSlam::loopCount() const {
  std::lock_guard<std::mutex> lock(mutex_);
  return closed_loops_.size();
}

std::vector<ClosedLoop> SparseSlam::closedLoops() const {
  std::lock_guard<std::mutex> lock(mutex_);
  return closed_loops_;
}

std::vector<Eigen::Vector3d> SparseSlam::landmarkPositions() const {
  std::lock_guard<std::mutex> lock(mutex_);
  std::vector<Eigen::Vector3d> positions;
  positions.reserve(map_.landmarks().size());
  for (const auto& [id, landmark] : map_.landmarks()) {
    static_cast<void>(id);
    if (map_.isPlaced(landmark.reference_keyframe)) positions.push_back(landmark.position_world);
  }
  return positions;
}

}  // namespace semantic_vslam
