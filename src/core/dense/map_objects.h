// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "core/dense/keyframe_cloud.h"
#include "semantic_vslam/core/dense/dense_config.h"
#include "semantic_vslam/core/dense/dense_result.h"

namespace semantic_vslam {

/// Groups the labelled points of a cloud into objects: 26-connected cubes that hold points of one class, and pieces of
/// one class that lie over each other, or near each other where one is a fragment or both are flat and equally high.
/// Background (label 0) makes none. @param cloud  z up  @return objects in ascending order of label, then of place.
/// @throws ConfigError
std::vector<MapObject> findObjects(const std::vector<LabelledPoint>& cloud, const MapObjectsConfig& config);

}  // namespace semantic_vslam
