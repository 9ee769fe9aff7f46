// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/map/map.h"
#include "core/map/tracked_frame.h"

namespace semantic_vslam {

struct LocalMapConfig {
  int max_keyframes = 60;
  int neighbours = 10;
  double search_radius_px = 3.0;
  double wide_radius_px = 8.0;
  double min_view_cosine = 0.5;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("max_keyframes", max_keyframes, 5, 500, "keyframes whose landmarks are looked for in a frame");
    v.field("neighbours", neighbours, 0, 50, "covisible neighbours taken in of each keyframe that the frame matches");
    v.field("search_radius_px", search_radius_px, 1.0, 30.0,
            "search radius round a projected landmark, px at full size, seen along its usual direction");
    v.field("wide_radius_px", wide_radius_px, 1.0, 60.0, "the same seen obliquely (over 3.6 degrees off)");
    v.field("min_view_cosine", min_view_cosine, 0.0, 1.0,
            "landmarks seen further off their usual direction than this cosine (0.5: 60 degrees) are not looked for");
  }
};

/// The part of the map around a frame (Mur-Artal and Tardos 2015, section V.D).
struct LocalMap {
  std::vector<KeyframeId> keyframes;
  std::vector<LandmarkId> landmarks;  ///< of those keyframes, each once, in ascending order
  KeyframeId reference;               ///< the keyframe that shares most landmarks with the frame
};

/// Keyframes that share landmarks with the frame, their neighbours and parents; and all they see.
LocalMap selectLocalMap(const Map& map, const TrackedFrame& frame, const LocalMapConfig& config);

/// Looks for the local map's landmarks in the frame, at its current pose, and enters the matches into it.
/// @param virtual_bf_px_m  fx * virtual baseline: matches of other depth are refused; 0 = depth is not compared
/// @return all landmarks that should be visible in the frame, those matched before included
std::vector<LandmarkId> matchLocalMap(const Map& map, const LocalMap& local_map, double virtual_bf_px_m,
                                      const LocalMapConfig& config, TrackedFrame& frame);

}  // namespace semantic_vslam
