// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/map/map.h"
#include "semantic_vslam/core/camera/sensor_config.h"
#include "semantic_vslam/core/mapping/mapping_config.h"

namespace semantic_vslam {

/// Makes landmarks of a keyframe's static features that have none because their depth is missing or too far off to be
/// used: each is matched along its epipolar line in the covisible keyframes and triangulated (Mur-Artal and Tardos
/// 2015, section VI.C). A point is kept if the views' parallax is large enough, it lies in front of both cameras, fits
/// both pixels (chi-square, 95 %) and looks as large as its distances say.
/// @return landmarks made
int triangulateNewLandmarks(Map& map, KeyframeId keyframe, const SensorConfig& sensor,
                            const TriangulationConfig& config);

}  // namespace semantic_vslam
