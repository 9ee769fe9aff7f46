// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/dense/keyframe_cloud.h"
#include "semantic_vslam/core/dense/dense_config.h"
#include "semantic_vslam/core/dense/dense_result.h"

namespace semantic_vslam {

/// What is known of a point on the map's surface, beside its label.
struct SurfaceEvidence {
  double label_share = 0.0;  ///< of the votes, for its label
  Stamp last_seen;
};
using EvidenceAt = std::function<SurfaceEvidence(const Eigen::Vector3d& point)>;

/// Groups the labelled points of a cloud into objects: 26-connected cubes that hold points of one class. What stands
/// like a screen is divided where it hardly goes on along its length; pieces of one class are joined that lie over each
/// other, or near each other where one is a fragment or both are flat and equally high. Background (label 0) makes
/// none.
/// @param cloud  z up  @param evidence_at  for confidence and last_seen, or none
/// @return objects in ascending order of label, then of place.
/// @throws ConfigError
std::vector<MapObject> findObjects(const std::vector<LabelledPoint>& cloud, const MapObjectsConfig& config,
                                   const EvidenceAt& evidence_at = {});

/// Gives the objects that are found again and again their ids: one keeps its id while a thing of its class is where it
/// was, by less than half its size or 0.3 m. Of what is gone the id is kept for it to come back. Knows no thread.
class ObjectList {
 public:
  /// @param T_now_before  how the map has moved where an object is since the last call: a loop was closed
  void giveIds(
      std::vector<MapObject>& objects,
      const std::function<SE3(const MapObject&)>& T_now_before = [](const auto&) { return SE3::Identity(); });

 private:
  static constexpr std::size_t kMost = 1000;  ///< that are remembered
  std::vector<MapObject> known_;              ///< as found last; those of the newest call at the end
  std::uint32_t next_id_ = 1;
};

}  // namespace semantic_vslam
