// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "core/features/orb_extractor.h"
#include "core/map/map.h"
#include "core/tracking/frame_tracker.h"
#include "core/tracking/initializer.h"
#include "core/tracking/keyframe_policy.h"
#include "core/tracking/local_map.h"
#include "semantic_vslam/core/tracking/tracking_config.h"
#include "semantic_vslam/core/tracking/tracking_state.h"

namespace semantic_vslam {

/// The same for who keeps the map.
struct TrackingResult : TrackingEstimate {
  KeyframeId reference;  ///< keyframe that shares most landmarks with the frame
  bool keyframe_is_due = false;
  std::vector<LandmarkId> visible;  ///< landmarks that the frame should have seen, for the map's counts
  std::vector<LandmarkId> found;    ///< those that it did see
  /// k1, when this frame completed the initialisation: the caller makes it the first keyframe, calls startFrom() with
  /// it and tracks this frame again.
  std::optional<TrackedFrame> first_frame;
};

/// Follows the camera frame by frame (Mur-Artal and Tardos 2017, section III, for RGB-D): prediction by constant
/// velocity, the last frame's points, then the local map. Knows no thread and owns no map.
class Tracker {
 public:
  /// @throws ConfigError
  explicit Tracker(const TrackerConfig& config);

  /// Needs no map, so it can run while the map is in other hands. @param dynamic  see OrbExtractor::extract().
  TrackedFrame prepare(const RgbdFrame& frame, const cv::Mat1b& dynamic) const;

  /// Finds the frame's pose. When `keyframe_is_due` the caller may make a keyframe of lastFrame() and tells by
  /// keyframeInserted().
  TrackingResult track(TrackedFrame frame, const Map& map, bool mapper_idle);

  const TrackedFrame& lastFrame() const { return *last_; }
  /// The frame just tracked is now this keyframe; the landmarks that were made of it are taken over.
  void keyframeInserted(const Map& map, KeyframeId id);
  /// To be called with frames that tracking and relocalisation have both failed on.
  /// @param mapped_s  the time that went into the map: so long its place is waited for, but 1 s at least and
  /// new_map_after_s at most
  /// @return k1 of a new map, at its origin, if the camera has been lost for long enough and this frame completes a
  /// pair
  std::optional<TrackedFrame> offerForNewMap(TrackedFrame frame, double mapped_s);
  /// Goes on from a frame whose pose and landmarks are known: k1 of the initialisation, or one found by relocalisation.
  void startFrom(TrackedFrame frame, KeyframeId reference);
  /// The map was corrected: the last frame goes with its reference keyframe.
  void followReference(const SE3& T_reference_world_before, const SE3& T_reference_world_after);
  /// There is a map, but no frame has found its place in it yet.
  void awaitRelocalisation();
  KeyframeId reference() const { return reference_; }
  void reset();

 private:
  TrackingResult initialise(TrackedFrame frame);
  PoseEstimate followLastFrame(const Map& map, TrackedFrame& frame) const;
  PoseEstimate followLocalMap(const Map& map, TrackedFrame& frame, TrackingResult& result);
  TrackingResult trackingFailed(TrackedFrame& frame);
  bool keyframeIsDue(const Map& map, const TrackedFrame& frame, int inliers, bool mapper_idle) const;

  TrackerConfig config_;
  OrbExtractor orb_;
  Initializer initializer_;
  TrackingState state_ = TrackingState::kInitialising;
  std::optional<TrackedFrame> last_;  ///< last frame with a pose
  std::optional<SE3> velocity_;       ///< T_current_last per frame of the stream
  std::optional<Stamp> lost_since_;   ///< first frame that had no pose
  KeyframeId reference_;
  std::uint64_t last_keyframe_index_ = 0;
  int most_tracked_ = 0;  // inliers since the last keyframe, of the frame that had most
};

}  // namespace semantic_vslam
