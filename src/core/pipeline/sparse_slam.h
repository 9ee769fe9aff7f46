// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/common/abort_flag.h"
#include "core/loop/map_joiner.h"
#include "core/pipeline/loop_closer.h"
#include "core/pipeline/sparse_state.h"
#include "core/pipeline/tracking_stage.h"
#include "semantic_vslam/core/common/stage_timing.h"
#include "semantic_vslam/core/geometry/timed_pose.h"
#include "semantic_vslam/core/pipeline/config.h"

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
/// begun beside it, and joined with it when a place of the old one is seen again. Owner of the sparse map and the
/// trajectory. Knows no thread: of all functions only prepare(), and maintain() and adjustAll() but for what they run
/// alone, may be called beside another.
class SparseSlam {
 public:
  /// @throws ConfigError
  explicit SparseSlam(const SparseSlamConfig& config);
  SparseSlam(const SparseSlam&) = delete;
  SparseSlam& operator=(const SparseSlam&) = delete;

  /// First half of a step: the frame's features. Asks nothing of the map.
  /// @param dynamic  height x width, probability that a pixel moves, 0..255; empty = all static
  TrackedFrame prepare(const RgbdFrame& frame, const cv::Mat1b& dynamic) const;
  /// Second half: the frame's pose, and the keyframe that it may become. maintain() is to follow for each keyframe.
  SparseStep track(const TrackedFrame& frame, const TrackOptions& options);
  /// Local mapping around a new keyframe, and the loop that it may close.
  /// @param frame  index of the frame that it was made with, for `times`
  /// @param abort  ends the adjustment early, with what it reached
  /// @return whether a loop was closed: adjustAll() should follow
  bool maintain(KeyframeId keyframe, std::uint64_t frame, StageTimes& times, const Alone& alone,
                const AbortFlag& abort);
  /// Global bundle adjustment. @param abort  ends it early, with nothing changed
  void adjustAll(std::uint64_t frame, StageTimes& times, const Alone& alone, const AbortFlag& abort);

  /// All of these at once, on one thread: the same input gives the same output.
  SparseStep step(const RgbdFrame& frame, const cv::Mat1b& dynamic, StageTimes& times, bool localization_only = false);

  /// Forgets map and trajectory.
  void reset();
  /// The stamps to come are older than those before: the map stays, the camera is looked for in it, and the trajectory
  /// begins anew.
  void startTimeAnew();

  /// Writes the sparse map, whole or not at all.
  /// @return number of its keyframes  @throws Error if it has none: the file stays as it is  @throws FileError
  std::size_t saveMap(const std::string& path) const { return saveMap(path, state_.map); }
  static std::size_t saveMap(const std::string& path, const Map& map);
  /// Reads a saved map; the present one is not touched. @throws FileError
  SavedMap readMap(const std::string& path) const;
  /// Takes a saved map in the place of the present one; frames find their place in it by relocalisation.
  void loadMap(SavedMap saved);
  /// Both at once. @throws FileError; map and trajectory are then what they were.
  void loadMap(const std::string& path) { loadMap(readMap(path)); }

  const Map& map() const { return state_.map; }
  /// Grows with every change of the keyframes or their poses.
  std::uint64_t posesVersion() const { return state_.poses_version; }
  /// Of all frames whose place in the world is known; those of a new map come in when it is joined with the old one.
  /// @param most  of a longer one every second, third, ... frame
  std::vector<TimedPose> trajectory(std::size_t most = std::numeric_limits<std::size_t>::max()) const;
  /// Of the keyframes whose place in the world is known.
  std::vector<KeyframePose> keyframePoses() const;
  /// Whether a keyframe is in the map; one that is, but not among keyframePoses(), waits for its map to be joined.
  bool holds(KeyframeId keyframe) const { return state_.map.keyframe(keyframe) != nullptr; }
  std::size_t keyframeCount() const { return state_.map.keyframes().size(); }
  std::size_t landmarkCount() const { return state_.map.landmarks().size(); }
  std::size_t loopCount() const { return loops_.closedLoops().size(); }
  /// Every loop closed in this map, in order.
  const std::vector<ClosedLoop>& closedLoops() const { return loops_.closedLoops(); }
  /// Positions of all landmarks whose place in the world is known, metres.
  std::vector<Eigen::Vector3d> landmarkPositions() const;

 private:
  void beginMap(TrackedFrame first, SparseStep& step);
  /// Enters a tracked frame into counts and trajectory, and makes a keyframe of it if one is due.
  void record(const TrackedFrame& frame, const TrackOptions& options, SparseStep& step);
  void findAgain(const TrackedFrame& frame, const TrackOptions& options, TrackingResult& result);
  /// Where a frame that is to be a keyframe fits the map badly: looks whether it fits better elsewhere. A keyframe of a
  /// known place with a wrong pose would put a second copy of the place into the map, which confirms itself from then
  /// on.
  void confirmPlace(const TrackedFrame& frame, TrackingResult& result);
  void startAt(const RelocalisationResult& place, const TrackedFrame& frame, TrackingResult& result);
  /// Looks for the world's map in a frame that is tracked in a new one, and joins them once frames agree on it.
  void seekWorld(const TrackedFrame& frame, SparseStep& step);
  /// Drops maps that were begun and lost again at once, when the camera has gone on to another one.
  void dropAbandoned();
  KeyframeId insert(const TrackedFrame& frame);
  void insertLast(SparseStep& step);
  void adjustAround(KeyframeId keyframe, const Alone& alone, const AbortFlag& abort);

  const SparseSlamConfig config_;
  SparseState state_;
  LoopCloser loops_;
  WorldSeeker seeker_;
};

}  // namespace semantic_vslam
