// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "eval/synthetic/ray_target.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace semantic_vslam::synthetic {
namespace {

using Eigen::Matrix3f;
using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr float kNearM = 0.08F;

Cone coneOf(const Primitive& p) {
  Cone cone;
  if (p.shape == Shape::kFrustum) {
    cone.middle = 0.5F * (p.radius_end + p.radius_start);
    cone.slope = 0.5F * (p.radius_end - p.radius_start);
    cone.z_low = -1.0F;
    cone.z_high = 1.0F;
  } else if (p.shape == Shape::kRoundedCone) {
    cone.sine = std::clamp((p.radius_start - p.radius_end) / p.length, -1.0F, 1.0F);
    cone.cosine = std::sqrt(1.0F - cone.sine * cone.sine);
    cone.z_low = p.radius_start * cone.sine;
    cone.z_high = p.length + p.radius_end * cone.sine;
    cone.slope = -cone.sine / std::max(cone.cosine, 1e-3F);
    cone.middle = p.radius_start * cone.cosine - cone.slope * cone.z_low;
  }
  return cone;
}

// Intersections, all in local units: `o` ray origin, `d` ray direction, result t and face.

float intersectBox(const Vector3f& o, const Vector3f& d, int& face) {
  float enter = -kNoHit, leave = kNoHit;
  for (int axis = 0; axis < 3; ++axis) {
    const float inverse = 1.0F / d[axis];
    float t_low = (-1.0F - o[axis]) * inverse, t_high = (1.0F - o[axis]) * inverse;
    const bool from_low = inverse >= 0.0F;
    if (!from_low) std::swap(t_low, t_high);
    if (t_low > enter) {
      enter = t_low;
      face = 2 * axis + (from_low ? 0 : 1);
    }
    leave = std::min(leave, t_high);
  }
  return enter <= leave && enter > kNearM ? enter : kNoHit;
}

/// First hit of a sphere around (0, 0, z) of the given radius.
float intersectSphere(const Vector3f& o, const Vector3f& d, float z, float radius) {
  const Vector3f p(o.x(), o.y(), o.z() - z);
  const float a = d.squaredNorm(), b = p.dot(d), c = p.squaredNorm() - radius * radius;
  const float discriminant = b * b - a * c;
  if (discriminant < 0.0F) return kNoHit;
  const float t = (-b - std::sqrt(discriminant)) / a;
  return t > kNearM ? t : kNoHit;
}

/// First hit of a cone's side from outside.
float intersectCone(const Vector3f& o, const Vector3f& d, const Cone& cone) {
  const float r0 = cone.middle + cone.slope * o.z(), dr = cone.slope * d.z();
  const float a = d.x() * d.x() + d.y() * d.y() - dr * dr;
  const float b = o.x() * d.x() + o.y() * d.y() - r0 * dr;
  const float c = o.x() * o.x() + o.y() * o.y() - r0 * r0;
  const float discriminant = b * b - a * c;
  if (discriminant < 0.0F || std::abs(a) < 1e-12F) return kNoHit;
  const float root = std::sqrt(discriminant), inverse = 1.0F / a;
  const float t1 = (-b - root) * inverse, t2 = (-b + root) * inverse;
  for (const float t : {std::min(t1, t2), std::max(t1, t2)}) {
    const float z = o.z() + t * d.z();
    if (t > kNearM && z >= cone.z_low && z <= cone.z_high && cone.middle + cone.slope * z >= 0.0F) return t;
  }
  return kNoHit;
}

float intersectFrustum(const Primitive& p, const Cone& cone, const Vector3f& o, const Vector3f& d, int& face) {
  float nearest = intersectCone(o, d, cone);
  face = 0;
  const bool from_below = d.z() > 0.0F;
  const float t = ((from_below ? -1.0F : 1.0F) - o.z()) / d.z();
  const float radius = from_below ? p.radius_start : p.radius_end;
  const float x = o.x() + t * d.x(), y = o.y() + t * d.y();
  if (t > kNearM && t < nearest && x * x + y * y <= radius * radius) {
    nearest = t;
    face = from_below ? 4 : 5;
  }
  return nearest;
}

float intersectRoundedCone(const Primitive& p, const Cone& cone, const Vector3f& o, const Vector3f& d) {
  const float spheres =
      std::min(intersectSphere(o, d, 0.0F, p.radius_start), intersectSphere(o, d, p.length, p.radius_end));
  if (cone.cosine < 1e-3F) return spheres;  // one sphere holds the other
  return std::min(spheres, intersectCone(o, d, cone));
}

/// Bounds in x/z and y/z of the solid's box, its part behind the near plane cut off. @return false if nothing is left.
bool boundInImage(const Primitive& primitive, const SE3& T_camera_world, Target& target) {
  std::array<Vector3f, 8> corners = primitive.localCorners();
  const Eigen::Isometry3f T_camera_world_f = T_camera_world.cast<float>();
  for (auto& corner : corners) corner = T_camera_world_f * primitive.toWorld(corner);
  target.ray_low.setConstant(kNoHit);
  target.ray_high.setConstant(-kNoHit);
  target.nearest_m = kNoHit;
  const auto include = [&](const Vector3f& p) {
    const Vector2f ray = p.head<2>() / p.z();
    target.ray_low = target.ray_low.cwiseMin(ray);
    target.ray_high = target.ray_high.cwiseMax(ray);
    target.nearest_m = std::min(target.nearest_m, p.z());
  };
  for (int i = 0; i < 8; ++i) {
    if (corners[i].z() >= kNearM) include(corners[i]);
    for (const int bit : {1, 2, 4}) {
      const Vector3f &a = corners[i], &b = corners[i | bit];
      if ((i & bit) == 0 && (a.z() < kNearM) != (b.z() < kNearM)) {
        Vector3f cut = a + (b - a) * ((kNearM - a.z()) / (b.z() - a.z()));
        cut.z() = kNearM;
        include(cut);
      }
    }
  }
  return target.nearest_m < kNoHit;
}

}  // namespace

float intersect(const Target& target, float ray_x, float ray_y, int& face) {
  const Matrix3f& m = target.local_from_ray;
  const Vector3f d = m.col(0) * ray_x + m.col(1) * ray_y + m.col(2);
  face = 0;
  switch (target.primitive->shape) {
    case Shape::kBox: return intersectBox(target.origin, d, face);
    case Shape::kEllipsoid: return intersectSphere(target.origin, d, 0.0F, 1.0F);
    case Shape::kFrustum: return intersectFrustum(*target.primitive, target.side, target.origin, d, face);
    case Shape::kRoundedCone: return intersectRoundedCone(*target.primitive, target.side, target.origin, d);
  }
  return kNoHit;
}

std::vector<Target> makeTargets(const Scene& scene, const Primitives& moving, const SE3& T_world_camera) {
  const SE3 T_camera_world = T_world_camera.inverse();
  const Matrix3f R_world_camera = T_world_camera.rotation().cast<float>();
  const Vector3f center = T_world_camera.translation().cast<float>();
  std::vector<Target> targets(scene.primitives.size() + moving.size());
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const Primitive& p = i < scene.primitives.size() ? scene.primitives[i] : moving[i - scene.primitives.size()];
    Target& target = targets[i];
    if (!boundInImage(p, T_camera_world, target)) continue;
    const Matrix3f local_from_world =
        p.scale.cwiseInverse().asDiagonal() * Matrix3f(p.T_world_local.linear().transpose());
    target.local_from_ray = local_from_world * R_world_camera;
    target.origin = local_from_world * (center - p.T_world_local.translation());
    target.primitive = &p;
    target.side = coneOf(p);
  }
  return targets;
}

}  // namespace semantic_vslam::synthetic
