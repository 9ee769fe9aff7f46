// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/map/map.h"

namespace semantic_vslam {

/// Finds landmarks in a keyframe that does not see them yet: adds the observation, or merges with the landmark that the
/// feature already has (the one seen by more keyframes stays).
/// @return observations added and landmarks merged
int fuseInto(Map& map, const std::vector<LandmarkId>& landmarks, KeyframeId keyframe, double virtual_baseline_m,
             double radius_px);

}  // namespace semantic_vslam
