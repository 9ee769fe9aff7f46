// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "semantic_vslam/core/eval/synthetic/ray_caster.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace semantic_vslam::synthetic {
namespace {

using Eigen::Matrix3f;
using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr int kTilePx = 16;
constexpr float kNearM = 0.08F;
constexpr float kNoHit = std::numeric_limits<float>::max();

/// The part x^2 + y^2 = (middle + slope z)^2 of a cone between z_low and z_high. The side of a frustum, or the surface
/// that touches both spheres of a rounded cone; its normal is (cosine * radial, sine).
struct Cone {
  float middle = 0, slope = 0, z_low = 0, z_high = 0, sine = 0, cosine = 1;
};

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

/// A solid as the rays of one frame meet it: ray (x, y, 1) * t + camera centre, in local units. t is depth in metres.
struct Target {
  Matrix3f local_from_ray;
  Vector3f origin;
  const Primitive* primitive = nullptr;
  Vector2f ray_low, ray_high;  // x/z, y/z it may cover
  float nearest_m = 0.0F;      // no hit is nearer
  Cone side;                   // of a frustum or rounded cone
};

struct Hit {
  float depth_m = kNoHit;
  int target = -1;
  int face = 0;  // of a box 0..5; of a frustum 0 side, 4 bottom, 5 top

  bool sameSurface(const Hit& other) const { return target == other.target && face == other.face; }
};

// ---- intersections, all in local units; `o` ray origin, `d` ray direction, result t and face

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

// ---- sorting solids into the image

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

// ---- shading

struct Surface {
  Vector3f local;         // local units
  Vector3f normal_local;  // not normalised, in local units
  int material = 0;
};

Surface surfaceAt(const Target& target, const Hit& hit, float ray_x, float ray_y) {
  const Primitive& p = *target.primitive;
  const Matrix3f& m = target.local_from_ray;
  Surface s;
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

class Shader {
 public:
  Shader(const Scene& scene, const std::vector<Target>& targets, const std::vector<FloorShadow>& floor_shadows,
         const Lighting& lighting, const SE3& T_world_camera, float focal_px)
      : scene_(scene),
        targets_(targets),
        floor_shadows_(floor_shadows),
        lighting_(lighting),
        T_world_camera_(T_world_camera.cast<float>()),
        pixel_rad_(1.0F / focal_px) {}

  cv::Vec3f shade(const Hit& hit, float ray_x, float ray_y) const {
    if (hit.target < 0) return {40, 40, 40};
    const Target& target = targets_[hit.target];
    const Primitive& p = *target.primitive;
    const Surface s = surfaceAt(target, hit, ray_x, ray_y);
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

 private:
  /// Texture filtered over the pixel's footprint: by pyramid level across, by several taps along the view's slant.
  cv::Vec3f textureAt(const Primitive& p, const Surface& s, const Material& material, const Hit& hit,
                      const Vector3f& normal, const Vector3f& view) const {
    const Texture& texture = scene_.textures[material.texture];
    const SurfaceMap map = mapOf(p, s.local, hit.face, material.repeat_m);
    const Vector2f extent_m = material.repeat_m > 0.0F ? Vector2f(Vector2f::Constant(material.repeat_m)) : map.extent_m;
    const auto lookUp = [&](const Vector2f& position_m, float level) {
      Vector2f uv = position_m.cwiseQuotient(extent_m);
      if (material.rotate_quarter) std::swap(uv.x(), uv.y());
      return texture.sample(uv.x(), uv.y(), level);
    };
    const float texel_m = std::min(extent_m.x() / static_cast<float>(texture.width()),
                                   extent_m.y() / static_cast<float>(texture.height()));
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

  cv::Vec3f lightAt(const Primitive& p, const Material& material, const Vector3f& point, const Vector3f& normal,
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

  float shadowAt(const Primitive& p, const Vector3f& point, const Vector3f& normal) const {
    if (p.shadow_layer < 0 || normal.z() < 0.99F) return 1.0F;
    float light = scene_.shadow_layers[p.shadow_layer].at(point.x(), point.y());
    if (point.z() > 0.02F) return light;
    for (const auto& shadow : floor_shadows_) {
      const float q = (point.head<2>() - shadow.center_m).squaredNorm() / (shadow.radius_m * shadow.radius_m);
      if (q < 4.0F) light *= 1.0F - shadow.strength * std::exp(-q);
    }
    return light;
  }

  const Scene& scene_;
  const std::vector<Target>& targets_;
  const std::vector<FloorShadow>& floor_shadows_;
  const Lighting& lighting_;
  const Eigen::Isometry3f T_world_camera_;
  const float pixel_rad_;
};

// ---- image

using HitImage = std::vector<Hit>;  // row-major

/// Depth test of one solid over one tile. @return the farthest depth left in the tile.
float castTile(const Target& target, int index, const cv::Rect& area, const cv::Mat2f& rays, HitImage& hits) {
  float farthest = 0.0F;
  for (int v = area.y; v < area.y + area.height; ++v) {
    const cv::Vec2f* ray = rays.ptr<cv::Vec2f>(v);
    Hit* row = hits.data() + static_cast<std::size_t>(v) * rays.cols;
    for (int u = area.x; u < area.x + area.width; ++u) {
      int face;
      const float depth_m = intersect(target, ray[u][0], ray[u][1], face);
      if (depth_m < row[u].depth_m) row[u] = {depth_m, index, face};
      farthest = std::max(farthest, row[u].depth_m);
    }
  }
  return farthest;
}

/// The solids that the pixels around (u, v) show: at most 9.
int neighbourTargets(const HitImage& hits, const cv::Size& size, int u, int v, std::array<int, 9>& found) {
  int count = 0;
  for (int y = std::max(v - 1, 0); y <= std::min(v + 1, size.height - 1); ++y) {
    for (int x = std::max(u - 1, 0); x <= std::min(u + 1, size.width - 1); ++x) {
      const int target = hits[static_cast<std::size_t>(y) * size.width + x].target;
      if (target >= 0 && std::find(found.begin(), found.begin() + count, target) == found.begin() + count) {
        found[count++] = target;
      }
    }
  }
  return count;
}

bool onOutline(const HitImage& hits, const cv::Size& size, int u, int v) {
  const std::size_t at = static_cast<std::size_t>(v) * size.width + u;
  const Hit& hit = hits[at];
  return (u > 0 && !hit.sameSurface(hits[at - 1])) || (u + 1 < size.width && !hit.sameSurface(hits[at + 1])) ||
         (v > 0 && !hit.sameSurface(hits[at - size.width])) ||
         (v + 1 < size.height && !hit.sameSurface(hits[at + size.width]));
}

/// Nearest of the candidate solids along one ray.
Hit castOne(const std::vector<Target>& targets, const std::array<int, 9>& candidates, int count, const cv::Vec2f& ray) {
  Hit nearest;
  for (int i = 0; i < count; ++i) {
    int face;
    const float depth_m = intersect(targets[candidates[i]], ray[0], ray[1], face);
    if (depth_m < nearest.depth_m) nearest = {depth_m, candidates[i], face};
  }
  return nearest;
}

/// Four rays inside the pixel (rotated grid) find the surfaces; each is shaded once and weighs as many rays as hit it.
cv::Vec3f shadeOutline(const std::vector<Target>& targets, const Shader& shader, const HitImage& hits,
                       const cv::Mat2f& rays, int u, int v) {
  static constexpr float kOffsets[4][2] = {{-0.125F, -0.375F}, {0.375F, -0.125F}, {-0.375F, 0.125F}, {0.125F, 0.375F}};
  std::array<int, 9> candidates;
  const int count = neighbourTargets(hits, rays.size(), u, v, candidates);
  const cv::Vec2f center = rays(v, u);
  const cv::Vec2f step_u = u + 1 < rays.cols ? rays(v, u + 1) - center : center - rays(v, u - 1);
  const cv::Vec2f step_v = v + 1 < rays.rows ? rays(v + 1, u) - center : center - rays(v - 1, u);
  std::array<Hit, 4> found;
  std::array<cv::Vec2f, 4> found_rays;
  for (int i = 0; i < 4; ++i) {
    found_rays[i] = center + step_u * kOffsets[i][0] + step_v * kOffsets[i][1];
    found[i] = castOne(targets, candidates, count, found_rays[i]);
    if (found[i].target < 0) found[i] = hits[static_cast<std::size_t>(v) * rays.cols + u];
  }
  cv::Vec3f sum(0, 0, 0);
  for (int i = 0; i < 4; ++i) {
    const auto same = [&](const Hit& other) { return other.sameSurface(found[i]); };
    if (std::any_of(found.begin(), found.begin() + i, same)) continue;  // shaded already
    const auto weight = static_cast<float>(std::count_if(found.begin() + i, found.end(), same));
    sum += shader.shade(found[i], found_rays[i][0], found_rays[i][1]) * (0.25F * weight);
  }
  return sum;
}

}  // namespace

RayCaster::RayCaster(std::shared_ptr<const CameraModel> camera) : camera_(std::move(camera)) {
  const cv::Mat2f& rays = camera_->rays();
  for (int y = 0; y < rays.rows; y += kTilePx) {
    for (int x = 0; x < rays.cols; x += kTilePx) {
      Tile tile;
      tile.area = cv::Rect(x, y, kTilePx, kTilePx) & cv::Rect({0, 0}, rays.size());
      tile.ray_low.setConstant(kNoHit);
      tile.ray_high.setConstant(-kNoHit);
      for (const cv::Vec2f& ray : cv::Mat2f(rays(tile.area))) {
        tile.ray_low = tile.ray_low.cwiseMin(Vector2f(ray[0], ray[1]));
        tile.ray_high = tile.ray_high.cwiseMax(Vector2f(ray[0], ray[1]));
      }
      tiles_.push_back(tile);
    }
  }
}

Rendering RayCaster::render(const Scene& scene, const Primitives& moving, const std::vector<FloorShadow>& floor_shadows,
                            const Lighting& lighting, const SE3& T_world_camera) const {
  const cv::Mat2f& rays = camera_->rays();
  const std::vector<Target> targets = makeTargets(scene, moving, T_world_camera);
  HitImage hits(rays.total());
  std::vector<int> in_tile;
  for (const Tile& tile : tiles_) {
    in_tile.clear();
    for (std::size_t i = 0; i < targets.size(); ++i) {
      const Target& t = targets[i];
      if (t.primitive && (t.ray_low.array() <= tile.ray_high.array()).all() &&
          (t.ray_high.array() >= tile.ray_low.array()).all()) {
        in_tile.push_back(static_cast<int>(i));
      }
    }
    std::stable_sort(in_tile.begin(), in_tile.end(),
                     [&](int a, int b) { return targets[a].nearest_m < targets[b].nearest_m; });
    float farthest = kNoHit;
    for (const int i : in_tile) {
      if (targets[i].nearest_m > farthest) break;
      farthest = castTile(targets[i], i, tile.area, rays, hits);
    }
  }

  const Shader shader(scene, targets, floor_shadows, lighting, T_world_camera, static_cast<float>(camera_->fx()));
  Rendering rendering{cv::Mat3b(rays.size()), cv::Mat1f(rays.size(), 0.0F), cv::Mat1i(rays.size(), -1)};
  for (int v = 0; v < rays.rows; ++v) {
    for (int u = 0; u < rays.cols; ++u) {
      const Hit& hit = hits[static_cast<std::size_t>(v) * rays.cols + u];
      const bool outline = onOutline(hits, rays.size(), u, v);
      rendering.bgr(v, u) =
          outline ? shadeOutline(targets, shader, hits, rays, u, v) : shader.shade(hit, rays(v, u)[0], rays(v, u)[1]);
      if (hit.target < 0) continue;
      rendering.depth_m(v, u) = hit.depth_m;
      rendering.primitive(v, u) = hit.target;
    }
  }
  return rendering;
}

}  // namespace semantic_vslam::synthetic
