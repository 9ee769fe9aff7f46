// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

#include "eval/synthetic/scene.h"
#include "semantic_vslam/core/geometry/se3.h"

namespace semantic_vslam::synthetic {

constexpr float kNoHit = std::numeric_limits<float>::max();

/// The part x^2 + y^2 = (middle + slope z)^2 of a cone between z_low and z_high. The side of a frustum, or the surface
/// that touches both spheres of a rounded cone; its normal is (cosine * radial, sine).
struct Cone {
  float middle = 0, slope = 0, z_low = 0, z_high = 0, sine = 0, cosine = 1;
};

/// A solid as the rays of one frame meet it: ray (x, y, 1) * t + camera centre, in local units. t is depth in metres.
struct Target {
  Eigen::Matrix3f local_from_ray;
  Eigen::Vector3f origin;
  const Primitive* primitive = nullptr;
  Eigen::Vector2f ray_low, ray_high;  // x/z, y/z it may cover
  float nearest_m = 0.0F;             // no hit is nearer
  Cone side;                          // of a frustum or rounded cone
};

struct Hit {
  float depth_m = kNoHit;
  int target = -1;
  int face = 0;  // of a box 0..5; of a frustum 0 side, 4 bottom, 5 top

  bool sameSurface(const Hit& other) const { return target == other.target && face == other.face; }
};

/// @param face  of a box or frustum that is hit, as in Hit
/// @return depth in metres along the ray (ray_x, ray_y, 1); kNoHit if it misses, or hits what the camera is inside of
float intersect(const Target& target, float ray_x, float ray_y, int& face);

/// One target per solid, the scene's first; those that the camera cannot see have no primitive.
std::vector<Target> makeTargets(const Scene& scene, const Primitives& moving, const SE3& T_world_camera);

}  // namespace semantic_vslam::synthetic
