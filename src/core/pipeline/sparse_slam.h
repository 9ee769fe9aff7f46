// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <condition_variable>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "core/loop/map_joiner.h"
#include "core/pipeline/loop_closer.h"
#include "core/pipeline/shared_map.h"
#include "core/runtime/bounded_queue.h"
#include "core/runtime/latest_task.h"
#include "semantic_vslam/core/common/stage_timing.h"
#include "semantic_vslam/core/geometry/timed_pose.h"
#include "semantic_vslam/core/map/keyframe_pose.h"
#include "semantic_vslam/core/pipeline/sparse_slam_config.h"

namespace semantic_vslam {

/// What became of one frame.
struct SparseStep {
  TrackingResult tracking;
  std::optional<KeyframeId> first_keyframe;  ///< k1, when this frame completed the initialisation
  Stamp first_stamp;                         ///< of k1
  std::optional<KeyframeId> keyframe;        ///< this frame, if it became a keyframe
  bool new_world = false;  ///< what was mapped before was too little to keep: poses are relative to another map now
};

/// A map from a file, its places indexed.
struct SavedMap {
  Map map;
  PlaceIndex places;
};

/// Tracking and the map behind it: frames are followed in the map; when the camera has been lost for long a new map is
/// begun beside it, and joined with it when a place of the old one is seen again. Owner of the sparse map, the
/// trajectory and, in the background mode, of the worker that maintains the map. step() is called by one thread;
/// everything else by any.
class SparseSlam {
 public:
  enum class Mode {
    kSynchronous,  ///< step() also maintains the map: the same input gives the same output
    /// A worker maintains the map and another one adjusts all of it after a loop, until the next loop aborts that.
    /// step() waits for them only for the length of a map update.
    kBackground
  };

  /// @throws ConfigError
  SparseSlam(const SparseSlamConfig& config, Mode mode);
  ~SparseSlam();
  SparseSlam(const SparseSlam&) = delete;
  SparseSlam& operator=(const SparseSlam&) = delete;

  /// @param dynamic  height x width, probability that a pixel moves, 0..255; empty = all static
  /// @param times    must outlive this object in the background mode
  SparseStep step(const RgbdFrame& frame, const cv::Mat1b& dynamic, StageTimes& times);

  /// Waits until the workers have dealt with every keyframe and loop so far. Nothing to do in the synchronous mode.
  void finish();
  /// Forgets map and trajectory.
  void reset();
  /// The stamps to come are older than those before: the map stays, the camera is looked for in it, and the trajectory
  /// begins anew.
  void startTimeAnew();
  /// In localisation-only mode the map is read, never changed, nor is one begun.
  void setLocalizationOnly(bool on) { localization_only_ = on; }
  bool localizationOnly() const { return localization_only_; }

  /// Writes the sparse map, whole or not at all.
  /// @return number of its keyframes  @throws Error if it has none: the file stays as it is  @throws FileError
  std::size_t saveMap(const std::string& path) const;
  /// Reads a saved map; the present one is not touched. @throws FileError
  SavedMap readMap(const std::string& path) const;
  /// Takes a saved map in the place of the present one; frames find their place in it by relocalisation.
  void loadMap(SavedMap saved);
  /// Both at once. @throws FileError; map and trajectory are then what they were.
  void loadMap(const std::string& path) { loadMap(readMap(path)); }

  /// Of all frames whose place in the world is known; those of a new map come in when it is joined with the old one.
  /// @param most  of a longer one every second, third, ... frame
  std::vector<TimedPose> trajectory(std::size_t most = std::numeric_limits<std::size_t>::max()) const;
  /// Of the keyframes whose place in the world is known.
  std::vector<KeyframePose> keyframePoses() const;
  /// Whether a keyframe is in the map; one that is, but not among keyframePoses(), waits for its map to be joined.
  bool holds(KeyframeId keyframe) const;
  std::size_t keyframeCount() const;
  std::size_t landmarkCount() const;
  std::size_t loopCount() const { return loops_.count(); }
  /// Every loop closed in this map, in order.
  std::vector<ClosedLoop> closedLoops() const { return loops_.closedLoops(); }
  /// Positions of all landmarks whose place in the world is known, metres.
  std::vector<Eigen::Vector3d> landmarkPositions() const;

 private:
  /// A keyframe whose surroundings are to be maintained, and where to report the time.
  struct Upkeep {
    KeyframeId keyframe;
    std::uint64_t frame;  ///< index of the frame that it was made with
    StageTimes* times;
  };

  SparseStep trackLocked(const TrackedFrame& frame);
  void beginMapLocked(TrackedFrame first, SparseStep& step);
  /// Enters a tracked frame into counts and trajectory, and makes a keyframe of it if one is due.
  void recordLocked(const TrackedFrame& frame, SparseStep& step);
  void relocaliseLocked(const TrackedFrame& frame, TrackingResult& result);
  /// Looks for the world's map in a frame that is tracked in a new one, and joins them once frames agree on it.
  void seekWorldLocked(const TrackedFrame& frame, SparseStep& step);
  /// Drops maps that were begun and lost again at once, when the camera has gone on to another one.
  void dropAbandonedLocked();
  KeyframeId insertLocked(const TrackedFrame& frame);
  void maintain(const Upkeep& upkeep);
  void adjustAround(KeyframeId keyframe);
  void startAdjustingAll(const Upkeep& upkeep);
  void waitForUpkeep();
  void work();

  const SparseSlamConfig config_;
  const Mode mode_;

  SharedMap shared_;
  LoopCloser loops_;
  WorldSeeker seeker_;  // guarded by shared_.mutex
  std::atomic<bool> localization_only_{false};

  std::atomic<bool> abort_ba_{false};
  std::atomic<int> pending_{0};  ///< keyframes queued or in work
  std::condition_variable idle_;
  BoundedQueue<Upkeep> queue_;
  LatestTask global_ba_;  ///< used in the background mode
  std::thread worker_;    ///< last member: starts when all else is there, joined first
};

}  // namespace semantic_vslam
