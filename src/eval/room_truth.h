// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "eval/synthetic/scene.h"

namespace semantic_vslam {

/// Distance of a point to a solid's surface, metres, below 0 inside. Exact for boxes, and for round shapes that are
/// scaled alike along x and y; an ellipsoid's is right to first order, that is, close to its surface.
/// @param point  world, metres
double signedDistance(const synthetic::Primitive& solid, const Eigen::Vector3d& point);

/// The exact geometry of a rendered room, to judge maps by. World frame: z up, the floor is z = 0.
class RoomTruth {
 public:
  /// @param solids  all that stands still, see SyntheticRoom::standingAtTheEnd()
  explicit RoomTruth(synthetic::Primitives solids);

  struct Nearest {
    double distance_m = kReachM;  ///< to the surface, 0 or more; kReachM where nothing is as near as that
    std::uint8_t label = 0;
    int thing = -1;  ///< Primitive::thing
  };
  static constexpr double kReachM = 0.15;
  Nearest nearest(const Eigen::Vector3d& point) const;

  /// Whether anything solid stands over a place between two heights.
  bool obstacleOver(double x_m, double y_m, double low_m, double high_m) const;

  const synthetic::Primitives& solids() const { return solids_; }

 private:
  const std::vector<int>& near(const Eigen::Vector3d& point) const;

  synthetic::Primitives solids_;
  std::unordered_map<std::uint64_t, std::vector<int>> cells_;  ///< solids whose box, widened by kReachM, meets a cube
};

}  // namespace semantic_vslam
