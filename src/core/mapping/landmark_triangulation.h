// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/map/map.h"
#include "semantic_vslam/core/camera/sensor_config.h"

namespace semantic_vslam {

struct TriangulationConfig {
  int neighbours = 10;
  double min_parallax_deg = 1.0;
  double match_ratio = 0.8;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("neighbours", neighbours, 0, 50,
            "covisible keyframes that a new keyframe's points without usable depth are triangulated with; 0 = none");
    v.field("min_parallax_deg", min_parallax_deg, 0.1, 30.0,
            "least angle between the two views: at 1 degree a pixel's error is a tenth of the distance");
    v.field("match_ratio", match_ratio, 0.5, 1.0,
            "Lowe's test among the features along the epipolar line: their place says little by itself");
  }
};

/// Makes landmarks of a keyframe's static features that have none because their depth is missing or too far off to be
/// used: each is matched along its epipolar line in the covisible keyframes and triangulated (Mur-Artal and Tardos
/// 2015, section VI.C). A point is kept if the views' parallax is large enough, it lies in front of both cameras, fits
/// both pixels (chi-square, 95 %) and looks as large as its distances say.
/// @return landmarks made
int triangulateNewLandmarks(Map& map, KeyframeId keyframe, const SensorConfig& sensor,
                            const TriangulationConfig& config);

}  // namespace semantic_vslam
