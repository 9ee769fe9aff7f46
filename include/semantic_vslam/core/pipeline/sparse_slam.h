// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "semantic_vslam/core/common/bounded_queue.h"
#include "semantic_vslam/core/dense/keyframe_cloud.h"
#include "semantic_vslam/core/eval/stage_timing.h"
#include "semantic_vslam/core/features/place_index.h"
#include "semantic_vslam/core/loop/loop_corrector.h"
#include "semantic_vslam/core/loop/loop_detector.h"
#include "semantic_vslam/core/map/map.h"
#include "semantic_vslam/core/map/map_maintenance.h"
#include "semantic_vslam/core/optimization/bundle_adjustment.h"
#include "semantic_vslam/core/tracking/relocalizer.h"
#include "semantic_vslam/core/tracking/tracker.h"
#include "semantic_vslam/core/tracking/trajectory_log.h"

namespace semantic_vslam {

struct SparseSlamConfig {
  TrackerConfig tracking;
  MapMaintenanceConfig mapping;
  BaConfig local_ba;
  PlaceIndexConfig places;
  RelocalizerConfig relocalisation;
  bool close_loops = true;
  LoopDetectorConfig loop_detection;
  LoopCorrectorConfig loop_correction;

  template <class Visitor>
  void visit(Visitor& v) {
    v.group("sensor", tracking.frame.sensor);
    v.group("tracking", tracking);
    v.group("mapping", mapping);
    v.group("local_ba", local_ba);
    v.group("places", places);
    v.group("relocalisation", relocalisation);
    v.flag("close_loops", close_loops, "false: places seen again are not looked for; drift stays");
    v.group("loop_detection", loop_detection);
    v.group("loop_correction", loop_correction);
  }
};

/// What became of one frame.
struct SparseStep {
  TrackingResult tracking;
  std::optional<KeyframeId> first_keyframe;  ///< k1, when this frame completed the initialisation
  Stamp first_stamp;                         ///< of k1
  std::optional<KeyframeId> keyframe;        ///< this frame, if it became a keyframe
};

/// Tracking and the map behind it: owner of the sparse map, the trajectory and, in the background mode, of the worker
/// that maintains the map. step() is called by one thread; everything else by any.
class SparseSlam {
 public:
  enum class Mode {
    kSynchronous,  ///< step() also maintains the map: the same input gives the same output
    kBackground    ///< a worker maintains the map; step() waits for it only for the length of a map update
  };

  /// @throws ConfigError
  SparseSlam(const SparseSlamConfig& config, Mode mode);
  ~SparseSlam();
  SparseSlam(const SparseSlam&) = delete;
  SparseSlam& operator=(const SparseSlam&) = delete;

  /// @param dynamic  height x width, probability that a pixel moves, 0..255; empty = all static
  /// @param times    must outlive this object in the background mode
  SparseStep step(const RgbdFrame& frame, const cv::Mat1b& dynamic, StageTimes& times);

  /// Waits until the worker has dealt with every keyframe so far. Nothing to do in the synchronous mode.
  void finish();
  /// Forgets map and trajectory.
  void reset();
  /// In localisation-only mode the map is read, never changed.
  void setLocalizationOnly(bool on) { localization_only_ = on; }

  /// Writes the sparse map, whole or not at all. @throws FileError
  void saveMap(const std::string& path) const;
  /// Takes a saved map in the place of the present one; frames find their place in it by relocalisation.
  /// @throws FileError; map and trajectory are then what they were.
  void loadMap(const std::string& path);

  std::vector<TimedPose> trajectory() const;
  std::vector<KeyframePose> keyframePoses() const;
  std::size_t keyframeCount() const;
  std::size_t landmarkCount() const;
  std::size_t loopCount() const;
  /// Positions of all landmarks, metres, in the world.
  std::vector<Eigen::Vector3d> landmarkPositions() const;

 private:
  /// A keyframe whose surroundings are to be maintained, and where to report the time.
  struct Upkeep {
    KeyframeId keyframe;
    StageTimes* times;
  };

  SparseStep trackLocked(const TrackedFrame& frame);
  void relocaliseLocked(const TrackedFrame& frame, TrackingResult& result);
  KeyframeId insertLocked(const TrackedFrame& frame);
  void maintain(KeyframeId keyframe, StageTimes& times);
  void adjustAround(KeyframeId keyframe);
  void closeLoop(KeyframeId keyframe);
  void adjustAll();
  /// Runs a change of the map that may move keyframes; tracking's last frame moves with its reference.
  template <class Change>
  bool changeLocked(const Change& change);
  void work();

  const SparseSlamConfig config_;
  const Mode mode_;

  mutable std::mutex mutex_;
  Map map_;                     // guarded by mutex_
  PlaceIndex places_;           // guarded by mutex_
  LoopDetector loops_;          // guarded by mutex_
  std::size_t loop_count_ = 0;  // guarded by mutex_
  TrajectoryLog trajectory_;    // guarded by mutex_
  Tracker tracker_;             // guarded by mutex_, but for prepare(), which is const
  std::atomic<bool> localization_only_{false};

  std::atomic<bool> abort_ba_{false};
  std::atomic<int> pending_{0};  ///< keyframes queued or in work
  std::condition_variable idle_;
  BoundedQueue<Upkeep> queue_;
  std::thread worker_;  ///< last member: starts when all else is there, joined first
};

}  // namespace semantic_vslam
