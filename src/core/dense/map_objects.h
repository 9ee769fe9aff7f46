// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "core/dense/keyframe_cloud.h"

namespace semantic_vslam {

struct MapObjectsConfig {
  double cell_m = 0.06;
  int min_points = 100;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("cell_m", cell_m, 0.01, 1.0,
            "points of one class belong together if their cubes of this edge touch; things nearer than that are one");
    v.field("min_points", min_points, 1, 1000000,
            "smaller ones are left out: 100 points of a cloud at 1 cm are a surface of 10 x 10 cm");
  }
};

/// A connected piece of the map of one class.
struct MapObject {
  std::uint8_t label = 0;
  int points = 0;
  Eigen::Vector3d centroid_m = Eigen::Vector3d::Zero();  ///< mean of its points
  Eigen::AlignedBox3d box_m;                             ///< round its points, along the axes of the cloud's frame
};

/// Groups the labelled points of a cloud into objects: 26-connected cubes that hold points of one class. Background
/// (label 0) makes none. @return objects in ascending order of label, then of place.
/// @throws ConfigError
std::vector<MapObject> findObjects(const std::vector<LabelledPoint>& cloud, const MapObjectsConfig& config);

}  // namespace semantic_vslam
