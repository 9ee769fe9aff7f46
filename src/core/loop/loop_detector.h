// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <set>
#include <vector>

#include "core/features/place_index.h"
#include "core/loop/relocalizer.h"
#include "core/map/map.h"

namespace semantic_vslam {

struct LoopDetectorConfig {
  double min_score = 0.02;
  double min_score_share = 0.5;
  int max_candidates = 20;
  int consistent_keyframes = 3;
  int confirming_neighbours = 3;
  int min_confirming_matches = 25;
  double confirming_radius_px = 5.0;
  double max_drift_share = 0.05;
  double max_drift_base_m = 0.3;
  double max_drift_rad_per_m = 0.03;
  double max_drift_base_rad = 0.15;
  RelocalizerConfig verification;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("min_score", min_score, 0.0, 1.0, "share of a keyframe's features that a candidate must match");
    v.field("min_score_share", min_score_share, 0.0, 1.0,
            "a candidate must look at least this much like the keyframe as the least similar of its neighbours does");
    v.field("max_candidates", max_candidates, 1, 200, "keyframes of similar appearance that are looked at");
    v.field("consistent_keyframes", consistent_keyframes, 1, 20, "keyframes in a row that must point at one place");
    v.field(
        "confirming_neighbours", confirming_neighbours, 0, 10,
        "neighbours of the keyframe that must see the old landmarks too, where the loop would put them; where fewer "
        "should, all of these, and one at least");
    v.field("min_confirming_matches", min_confirming_matches, 5, 500, "landmarks that each of these must find");
    v.field("confirming_radius_px", confirming_radius_px, 1.0, 50.0, "search radius for these, px at full size");
    v.field("max_drift_share", max_drift_share, 0.0, 1.0,
            "drift that a loop may correct, metres for each metre travelled since the old place; RGB-D odometry drifts "
            "by 1-2 %. What asks for more is another room that looks the same");
    v.field("max_drift_base_m", max_drift_base_m, 0.0, 10.0, "added to that");
    v.field("max_drift_rad_per_m", max_drift_rad_per_m, 0.0, 1.0, "the same for rotation");
    v.field("max_drift_base_rad", max_drift_base_rad, 0.0, 3.2, "added to that");
    v.group("verification", verification);
  }
};

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
  LoopDetector(const LoopDetectorConfig& config, const FrameTrackerConfig& tracker);

  /// @param index  holds the map's keyframes; whether `current` is among them does not matter
  std::optional<LoopClosure> detect(const Map& map, const PlaceIndex& index, KeyframeId current);
  /// Forgets the keyframes seen so far: after a closed loop or a new map.
  void reset() { chains_.clear(); }

 private:
  /// Keyframes around a candidate, and how many keyframes in a row pointed at them.
  struct Chain {
    std::set<KeyframeId> group;
    int length = 1;
  };
  std::vector<KeyframeId> consistentCandidates(const Map& map, const std::vector<KeyframeId>& candidates);
  std::optional<LoopClosure> verify(const Map& map, const Keyframe& current, KeyframeId candidate,
                                    const std::set<KeyframeId>& around_current) const;
  bool driftExplains(const Map& map, const Keyframe& current, KeyframeId candidate, const SE3& T_current_world) const;
  bool neighboursConfirm(const Map& map, const Keyframe& current, const std::vector<KeyframeId>& group,
                         const SE3& T_current_world) const;

  LoopDetectorConfig config_;
  FrameTrackerConfig tracker_;
  std::vector<Chain> chains_;
};

}  // namespace semantic_vslam
