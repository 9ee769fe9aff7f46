// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "eval/synthetic/shader.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace semantic_vslam::synthetic {

using Eigen::Matrix3f;
using Eigen::Vector2f;
using Eigen::Vector3f;

struct SurfacePoint {
  Vector3f local;         // local units
  Vector3f normal_local;  // not normalised, in local units
  int material = 0;
};

namespace {

SurfacePoint surfaceAt(const Target& target, const Hit& hit, float ray_x, float ray_y) {
  const Primitive& p = *target.primitive;
  const Matrix3f& m = target.local_from_ray;
  SurfacePoint s;
  s.local = target.origin + (m.col(0) * ray_x + m.col(1) * ray_y + m.col(2)) * hit.depth_m;
  s.material = p.materials[0];
  if (p.shape == Shape::kBox || (p.shape == Shape::kFrustum && hit.face != 0)) {
    s.normal_local = Vector3f::Zero();
    s.normal_local[hit.face / 2] = (hit.face & 1) ? 1.0F : -1.0F;
    s.material = p.materials[hit.face];
  } else if (p.shape == Shape::kEllipsoid) {
    s.normal_local = s.local;
  } else if (p.shape == Shape::kFrustum) {
    s.normal_local = {s.local.x(), s.local.y(), -target.side.slope * s.local.head<2>().norm()};
  } else {
    const Cone& cone = target.side;
    const float radial = std::max(s.local.head<2>().norm(), 1e-6F);
    // Which part was hit: the point's foot on the axis, along the cone's normal, tells.
    const float foot = s.local.z() - radial * cone.sine / std::max(cone.cosine, 1e-3F);
    if (foot <= 0.0F) {
      s.normal_local = s.local;
    } else if (foot >= p.length) {
      s.normal_local = s.local - Vector3f(0, 0, p.length);
    } else {
      s.normal_local = {s.local.x() / radial * cone.cosine, s.local.y() / radial * cone.cosine, cone.sine};
    }
  }
  return s;
}

/// Texture position of a surface point, in metres (u_m, v_m), and the face's extent in metres.
struct SurfaceMap {
  Vector2f position_m, extent_m;
};

SurfaceMap mapFlat(const Primitive& p, const Vector3f& local, int face) {
  // u to the right and v downwards for someone who looks at the face from outside; the upper face is read from -x.
  const Vector3f at = p.scale.cwiseProduct(local), size = p.scale;
  switch (face) {
    case 0: return {{size.y() - at.y(), size.z() - at.z()}, {2 * size.y(), 2 * size.z()}};
    case 1: return {{size.y() + at.y(), size.z() - at.z()}, {2 * size.y(), 2 * size.z()}};
    case 2: return {{size.x() + at.x(), size.z() - at.z()}, {2 * size.x(), 2 * size.z()}};
    case 3: return {{size.x() - at.x(), size.z() - at.z()}, {2 * size.x(), 2 * size.z()}};
    case 4: return {{size.y() + at.y(), size.x() - at.x()}, {2 * size.y(), 2 * size.x()}};
    default: return {{size.y() - at.y(), size.x() - at.x()}, {2 * size.y(), 2 * size.x()}};
  }
}

/// Cushions, leaves and slabs are seen flat-on: their texture is projected along the thin axis, not wound round it.
bool isFlat(const Primitive& p, int& thin_axis) {
  const Vector3f reach =
      p.shape == Shape::kEllipsoid ? p.scale : Vector3f(p.scale * std::max(p.radius_start, p.radius_end));
  const float thin = p.shape == Shape::kEllipsoid ? reach.minCoeff(&thin_axis) : reach.head<2>().minCoeff(&thin_axis);
  return thin < 0.4F * reach.head<2>().maxCoeff();
}

SurfaceMap mapProjected(const Primitive& p, const Vector3f& local, int thin_axis) {
  const int u_axis = thin_axis == 0 ? 1 : 0, v_axis = thin_axis == 2 ? 1 : 2;
  const auto corners = p.localCorners();
  const Vector3f low = corners.front(), high = corners.back();
  const Vector3f at = p.scale.cwiseProduct(local - low), extent = p.scale.cwiseProduct(high - low);
  return {{at[u_axis], at[v_axis]}, {extent[u_axis], extent[v_axis]}};
}

SurfaceMap mapRound(const Primitive& p, const Vector3f& local, float repeat_m) {
  int thin_axis = 0;
  if (p.shape != Shape::kFrustum && isFlat(p, thin_axis)) return mapProjected(p, local, thin_axis);
  const float turn = std::atan2(local.y(), local.x()) / static_cast<float>(2.0 * M_PI) + 0.5F;  // front (+x) = 0.5
  float radius_m = 0.5F * (p.radius_start + p.radius_end) * 0.5F * (p.scale.x() + p.scale.y());
  float v_m = (1.0F - local.z()) * p.scale.z(), height_m = 2.0F * p.scale.z();
  if (p.shape == Shape::kEllipsoid) radius_m = 0.5F * (p.scale.x() + p.scale.y());
  if (p.shape == Shape::kRoundedCone) {
    height_m = (p.length + p.radius_start + p.radius_end) * p.scale.z();
    v_m = (p.length + p.radius_end - local.z()) * p.scale.z();
  }
  float around_m = static_cast<float>(2.0 * M_PI) * radius_m;
  // A whole number of repeats, so that there is no seam.
  if (repeat_m > 0.0F) around_m = std::max(1.0F, std::round(around_m / repeat_m)) * repeat_m;
  return {{turn * around_m, v_m}, {around_m, height_m}};
}

SurfaceMap mapOf(const Primitive& p, const Vector3f& local, int face, float repeat_m) {
  if (p.shape == Shape::kFrustum && face != 0) {
    Primitive cap = p;
    cap.scale *= std::max(p.radius_start, p.radius_end);
    return mapFlat(cap, local / std::max(p.radius_start, p.radius_end), face);
  }
  return p.shape == Shape::kBox ? mapFlat(p, local, face) : mapRound(p, local, repeat_m);
}

}  // namespace

Shader::Shader(const Scene& scene, const std::vector<Target>& targets, const std::vector<FloorShadow>& floor_shadows,
               const Lighting& lighting, const SE3& T_world_camera, float focal_px)
    : scene_(scene),
      targets_(targets),
      floor_shadows_(floor_shadows),
      lighting_(lighting),
      T_world_camera_(T_world_camera.cast<float>()),
      pixel_rad_(1.0F / focal_px) {}

cv::Vec3f Shader::shade(const Hit& hit, float ray_x, float ray_y) const {
  if (hit.target < 0) return {40, 40, 40};
  const Target& target = targets_[hit.target];
  const Primitive& p = *target.primitive;
  const SurfacePoint s = surfaceAt(target, hit, ray_x, ray_y);
  const Vector3f normal = (p.T_world_local.linear() * s.normal_local.cwiseQuotient(p.scale)).normalized();
  const Vector3f view = T_world_camera_.linear() * Vector3f(ray_x, ray_y, 1);
  const Vector3f point = T_world_camera_.translation() + view * hit.depth_m;
  const Material& material = scene_.materials[s.material];
  const cv::Vec3f albedo = textureAt(p, s, material, hit, normal, view);
  const cv::Vec3f light = lightAt(p, material, point, normal, view.normalized());
  cv::Vec3f color;
  for (int c = 0; c < 3; ++c) color[c] = albedo[c] * material.tint[c] * light[c];
  return color;
}

/// Texture filtered over the pixel's footprint: by pyramid level across, by several taps along the view's slant.
cv::Vec3f Shader::textureAt(const Primitive& p, const SurfacePoint& s, const Material& material, const Hit& hit,
                            const Vector3f& normal, const Vector3f& view) const {
  const Texture& texture = scene_.textures[material.texture];
  const SurfaceMap map = mapOf(p, s.local, hit.face, material.repeat_m);
  const Vector2f extent_m = material.repeat_m > 0.0F ? Vector2f(Vector2f::Constant(material.repeat_m)) : map.extent_m;
  const auto lookUp = [&](const Vector2f& position_m, float level) {
    Vector2f uv = position_m.cwiseQuotient(extent_m);
    if (material.rotate_quarter) std::swap(uv.x(), uv.y());
    return texture.sample(uv.x(), uv.y(), level);
  };
  const float texel_m =
      std::min(extent_m.x() / static_cast<float>(texture.width()), extent_m.y() / static_cast<float>(texture.height()));
  const float across_m = hit.depth_m * pixel_rad_;
  const float slant = std::max(std::abs(normal.dot(view)) / view.norm(), 0.05F);
  const int taps = std::clamp(static_cast<int>(1.0F / slant + 0.3F), 1, 4);
  const float along_m = across_m / slant;
  const float level = std::log2(std::max(std::max(across_m, along_m / static_cast<float>(taps)) / texel_m, 1.0F));
  if (taps == 1) return lookUp(map.position_m, level);

  const Vector3f slide = (view - normal * normal.dot(view)).normalized() * along_m;  // world, over the footprint
  const Vector3f slide_local = (p.T_world_local.linear().transpose() * slide).cwiseQuotient(p.scale);
  cv::Vec3f sum(0, 0, 0);
  for (int i = 0; i < taps; ++i) {
    const float offset = (static_cast<float>(i) + 0.5F) / static_cast<float>(taps) - 0.5F;
    sum += lookUp(mapOf(p, s.local + slide_local * offset, hit.face, material.repeat_m).position_m, level);
  }
  return sum * (1.0F / static_cast<float>(taps));
}

cv::Vec3f Shader::lightAt(const Primitive& p, const Material& material, const Vector3f& point, const Vector3f& normal,
                          const Vector3f& view) const {
  // Sky-like ambient light: more from above, and a little more from one side, so that no two walls are equal.
  const float occlusion = 0.78F + 0.16F * normal.z() + 0.06F * normal.x();
  const float near_floor =
      point.z() > 1.0F ? 1.0F : 1.0F - 0.25F * std::exp(-std::max(point.z(), 0.0F) / 0.25F) * (1.0F - normal.z());
  cv::Vec3f light = lighting_.ambient * (occlusion * near_floor);
  for (const auto& lamp : lighting_.lamps) {
    if (!lamp.reaches(point)) continue;
    const Vector3f to_lamp = lamp.position_m - point;
    const float distance2 = to_lamp.squaredNorm();
    const Vector3f direction = to_lamp / std::sqrt(distance2 + 1e-6F);
    const float facing = std::max(0.0F, (normal.dot(direction) + 0.25F) / 1.25F);
    const float reach2 = lamp.reach_m * lamp.reach_m;
    float strength = facing * 1.25F / (0.25F + distance2 / reach2 * 2.0F);
    if (material.gloss > 0.0F) {
      const float mirror = std::max(0.0F, (direction - view).normalized().dot(normal));
      const float mirror4 = mirror * mirror * mirror * mirror, mirror16 = mirror4 * mirror4 * mirror4 * mirror4;
      strength += material.gloss * mirror16 * mirror16;
    }
    light += lamp.color * strength;
  }
  light *= shadowAt(p, point, normal) * (1.0F - material.emission);
  return light + cv::Vec3f::all(material.emission);
}

float Shader::shadowAt(const Primitive& p, const Vector3f& point, const Vector3f& normal) const {
  if (p.shadow_layer < 0 || normal.z() < 0.99F) return 1.0F;
  float light = scene_.shadow_layers[p.shadow_layer].at(point.x(), point.y());
  if (point.z() > 0.02F) return light;
  for (const auto& shadow : floor_shadows_) {
    const float q = (point.head<2>() - shadow.center_m).squaredNorm() / (shadow.radius_m * shadow.radius_m);
    if (q < 4.0F) light *= 1.0F - shadow.strength * std::exp(-q);
  }
  return light;
}

}  // namespace semantic_vslam::synthetic
