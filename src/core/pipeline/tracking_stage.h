// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/common/abort_flag.h"
#include "core/pipeline/removal.h"
#include "semantic_vslam/core/camera/rgbd_frame.h"
#include "semantic_vslam/core/common/stage_timing.h"
#include "semantic_vslam/core/geometry/timed_pose.h"
#include "semantic_vslam/core/motion/motion_result.h"
#include "semantic_vslam/core/pipeline/config.h"
#include "semantic_vslam/core/pipeline/messages.h"
#include "semantic_vslam/core/tracking/tracking_state.h"

namespace semantic_vslam {

class Map;
class SparseSlam;
struct SavedMap;
struct TrackedFrame;

/// A frame and what is known of it when its turn comes.
struct TrackingInput {
  RgbdFrame frame;
  MotionResult motion;                ///< images empty: there is no mask of it
  std::optional<FrameLabels> labels;  ///< its own, where the start asked for them
  bool network_runs = false;          ///< labels may be hoped for
};

/// How one frame is to be tracked.
struct TrackOptions {
  bool localization_only = false;  ///< the map is read, never changed, nor is one begun
  bool upkeep_is_done = true;      ///< every keyframe so far has been through maintain(): another one is welcome
};

/// What is worked out only for who looks at it.
struct TrackingWishes {
  std::size_t path = 0;  ///< poses of the path at most
  bool points = false;   ///< the landmarks, when there are new keyframes
};

/// Stage 2: the frame's pose, the keyframes, and the sparse map behind them, which it alone owns.
///
/// The start. A map must begin without people. While there is none, a frame may become k1 only if the people in it are
/// known: because the motion stage carries fresh labels on to it, or by its own labels, which wantsLabels() asks for.
/// The next frame may become k2 without: motion detection removes its people; if it does not fit, k1 is released, and a
/// frame without labels does not take its place. Where no network runs, or no labels come for init_wait_s, motion
/// detection alone must do.
///
/// Knows no thread: of all functions only prepare(), and maintain() and adjustAll() but for what they run alone, may be
/// called beside another.
class TrackingStage {
 public:
  /// @param first_map_id  of MapSnapshot  @throws ConfigError
  TrackingStage(const SparseSlamConfig& config, const TrackingWaits& waits, const RemovalConfig& removal,
                std::uint32_t first_map_id = 0);
  ~TrackingStage();
  TrackingStage(TrackingStage&&) noexcept;

  /// To be called first for every frame. A recording that is played again begins a new map, unless the map is one to
  /// localise in; when a clock is set back, the map stays, and the trajectory begins anew.
  /// @param recording  see StampOrder  @return whether the frame is to be tracked; false: it is out of order
  bool accepts(Stamp stamp, std::uint32_t recording, bool localization_only);
  /// @return whether the frame waits for its own labels; without them it is not to be tracked
  bool wantsLabels(const TrackingInput& input);

  struct Prepared {
    std::shared_ptr<const TrackedFrame> frame;
    cv::Mat1b removed;
  };
  /// First half of a step: the features that do not move. Asks nothing of the map.
  Prepared prepare(const TrackingInput& input) const;
  /// Second half: pose, keyframes, map. maintain() is to follow for each keyframe.
  TrackingOutput track(const TrackingInput& input, const Prepared& prepared, const TrackOptions& options = {},
                       const TrackingWishes& wishes = {});

  /// See SparseSlam.
  using Alone = std::function<void(const std::function<void()>&)>;
  bool maintain(KeyframeId keyframe, std::uint64_t frame, StageTimes& times, const Alone& alone,
                const AbortFlag& abort);
  void adjustAll(std::uint64_t frame, StageTimes& times, const Alone& alone, const AbortFlag& abort);

  void take(const LabelSet& label_set);
  void reset();
  /// Reads a saved map; the present one is not touched, nor asked. @throws FileError
  std::shared_ptr<SavedMap> readMap(const std::string& path) const;
  /// Takes it in the place of the present one; frames find their place in it by relocalisation.
  void loadMap(SavedMap& saved);
  bool hasMap() const;
  /// @return map_id that the map had when it was saved; 0 if it was not loaded
  std::uint32_t loadedFrom() const;
  /// For saving: its origin is the map_id there is.
  Map copyMap() const;
  /// The map as it stands; the same object as before where nothing has changed.
  std::shared_ptr<const MapSnapshot> snapshot();
  const SparseSlam& slam() const;

 private:
  struct Inside;
  std::unique_ptr<Inside> inside_;
};

}  // namespace semantic_vslam
