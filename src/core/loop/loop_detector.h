// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>
#include <set>
#include <vector>

#include "core/features/place_index.h"
#include "core/loop/relocalizer.h"
#include "core/map/map.h"
#include "semantic_vslam/core/loop/loop_config.h"

namespace semantic_vslam {

/// A place seen again: where the current keyframe really is, by the landmarks of the first visit.
struct LoopClosure {
  KeyframeId current, matched;
  SE3 T_current_world = SE3::Identity();    ///< corrected; the map has the drifted pose
  SE3 T_current_matched = SE3::Identity();  ///< the same as a relative pose
  std::vector<LandmarkId> landmarks;        ///< per feature of current: the old landmark that it shows, or invalid
};

/// Tells when the camera is back at a place that the map knows, but does not connect to where the camera is (Mur-Artal
/// and Tardos 2015, section VII): similar appearance, several keyframes in a row; a pose by the old landmarks, strictly
/// verified; the same landmarks found in neighbours of the keyframe; and a correction no larger than drift can be.
/// Feed it every keyframe once, in order.
class LoopDetector {
 public:
  /// @param tracker  for the virtual baseline and the pose optimiser
  /// @throws ConfigError
  LoopDetector(const LoopDetectorConfig& config, const FramePoseConfig& tracker);

  /// @param index  holds the map's keyframes; whether `current` is among them does not matter
  std::optional<LoopClosure> detect(const Map& map, const PlaceIndex& index, KeyframeId current);
  /// Tells how sure a keyframe's place was when it was made, before detect() is given it. Where people cover the view,
  /// keyframes hang on one another, each on what little the last one left, and drift; from the first such one on, the
  /// map's older part is looked for at every keyframe, though tracking connects it already, until a sure one confirms
  /// that both parts fit, or the map is bent to make them.
  /// @param found_share  of the landmarks that should be in view
  void noteKeyframe(KeyframeId id, double found_share);
  /// Forgets the keyframes seen so far: after a closed loop or a new map.
  void reset() {
    chains_.clear();
    unsure_since_.reset();
  }

 private:
  /// Keyframes around a candidate, and how many keyframes in a row pointed at them.
  struct Chain {
    std::set<KeyframeId> group;
    int length = 1;
  };
  /// A place, and the keyframes whose landmarks told it.
  struct Found {
    RelocalisationResult place;
    std::vector<KeyframeId> group;
  };
  /// Where the keyframe is by the landmarks of the map as it was before the first unsure keyframe, if that is
  /// elsewhere.
  std::optional<LoopClosure> compareWithBefore(const Map& map, const PlaceIndex& index, const Keyframe& current);
  /// Where it is by the landmarks of some keyframes of its tree.
  std::optional<Found> findAmong(const Map& map, const PlaceIndex& index, const Keyframe& current,
                                 const std::function<bool(KeyframeId)>& among) const;
  std::vector<KeyframeId> consistentCandidates(const Map& map, const std::vector<KeyframeId>& candidates);
  std::optional<LoopClosure> verify(const Map& map, const Keyframe& current, KeyframeId candidate,
                                    const std::set<KeyframeId>& around_current) const;
  bool driftExplains(const Map& map, const Keyframe& current, KeyframeId candidate, const SE3& T_current_world) const;
  bool neighboursConfirm(const Map& map, const Keyframe& current, const std::vector<KeyframeId>& group,
                         const SE3& T_current_world) const;

  LoopDetectorConfig config_;
  FramePoseConfig tracker_;
  std::vector<Chain> chains_;
  std::optional<KeyframeId> unsure_since_;
  KeyframeId last_unsure_;
};

}  // namespace semantic_vslam
