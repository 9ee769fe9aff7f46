// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "eval/synthetic/ray_caster.h"
#include "eval/synthetic/scene.h"

namespace semantic_vslam::synthetic {

/// The walls of a room by the direction one looks at them from its middle.
enum class Side { kPlusX, kPlusY, kMinusX, kMinusY };

/// Opening in a wall. @param offset_m  of its middle from the middle of the wall, along world y (x walls) or x (y
/// walls)
struct Doorway {
  Side side = Side::kPlusX;
  double offset_m = 0.0;
};

enum class Furnishing {
  kOffice,   ///< desks, shelves, chairs along the walls; the middle stays free; a big desk group at +x
  kMeeting,  ///< the same with a round table in the middle
  kWallOnly  ///< nothing but papered walls, one of them plastered with posters: a plane that fills the view
};

struct RoomSpec {
  Eigen::Vector2d center_m = {0, 0};
  Eigen::Vector3d size_m = {6.0, 5.4, 2.6};  ///< inner length along x, y and height
  Furnishing furnishing = Furnishing::kOffice;
  std::vector<Doorway> doorways;
  std::uint64_t look_seed = 1;   ///< textures, kinds and shapes: rooms of the same look seed look alike
  std::uint64_t shift_seed = 1;  ///< with shift_m > 0: how the same things are moved about
  double shift_m = 0.0;          ///< largest shift of furniture against its place, along the wall
};

constexpr double kWallThicknessM = 0.06;

/// Builds a room into the scene, contact shadows included. @return its ceiling lamps.
std::vector<PointLight> buildRoom(const RoomSpec& spec, Scene& scene);

}  // namespace semantic_vslam::synthetic
