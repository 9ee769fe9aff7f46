// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "semantic_vslam/core/common/stamp.h"

namespace semantic_vslam {

/// What one frame shows of somebody or something that is kept out of the map. Frame: the map's, z up, metres.
struct MoverView {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< of the vertical axis
  double sigma_m = 0.1;                                ///< of each of its coordinates, standard deviation
  double bottom_m = 0.0, top_m = 0.0;                  ///< z
  double width_m = 0.0;                                ///< across the line of sight
  double area_m2 = 0.0;                                ///< of the surface that is seen
  double person_share = 0.0;                           ///< of that surface, labelled as a person

  /// Labels say so, or what is seen is as large as one who stands.
  bool isLikePerson() const;
};

/// Somebody or something that moves about, followed over time.
struct TrackedMover {
  std::uint32_t id = 0;  ///< stays while it is followed; never given twice
  bool person = false;   ///< see MoverView::isLikePerson(), over time; else anything that moves
  Eigen::Vector2d position = Eigen::Vector2d::Zero(), velocity = Eigen::Vector2d::Zero();  ///< m, m/s
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Identity();                                ///< of x y vx vy
  double bottom_m = 0.0, top_m = 0.0, width_m = 0.0;
  Stamp last_seen;
};

}  // namespace semantic_vslam
