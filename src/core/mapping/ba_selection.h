// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/map/map.h"
#include "core/optimization/bundle_adjustment.h"

namespace semantic_vslam {

/// The centre, its covisible keyframes and the landmarks they see; keyframes that see these from outside are fixed, as
/// is the map's first one. @return an empty problem if the centre is gone.
BaProblem selectLocal(const Map& map, KeyframeId centre, const SensorConfig& sensor, const BaConfig& config);

/// The whole map; the first keyframe of each tree is fixed.
BaProblem selectGlobal(const Map& map, const SensorConfig& sensor);

}  // namespace semantic_vslam
