// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/map/map.h"
#include "core/map/tracked_frame.h"
#include "semantic_vslam/core/tracking/tracking_config.h"

namespace semantic_vslam {

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
