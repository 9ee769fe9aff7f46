// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "eval/synthetic/scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

namespace semantic_vslam::synthetic {
namespace {

struct Bounds {
  Eigen::Vector3f low = Eigen::Vector3f::Constant(std::numeric_limits<float>::max());
  Eigen::Vector3f high = Eigen::Vector3f::Constant(std::numeric_limits<float>::lowest());
};

Bounds worldBounds(const Primitive& primitive) {
  Bounds bounds;
  for (const auto& corner : primitive.localCorners()) {
    const Eigen::Vector3f p = primitive.toWorld(corner);
    bounds.low = bounds.low.cwiseMin(p);
    bounds.high = bounds.high.cwiseMax(p);
  }
  return bounds;
}

/// Darkens the layer under one thing that stands `gap_m` above it: sharp and dark in contact, wide and faint above.
void castOn(ShadowLayer& layer, const Primitive& thing, float gap_m) {
  const float sigma_px = (0.025F + 0.30F * gap_m) * layer.px_per_m;
  const float strength = 0.5F * std::exp(-gap_m / 0.6F);
  std::vector<cv::Point2f> footprint;
  for (const auto& corner : thing.localCorners()) {
    const Eigen::Vector2f px = (thing.toWorld(corner).head<2>() - layer.origin_m) * layer.px_per_m;
    footprint.emplace_back(px.x(), px.y());
  }
  std::vector<cv::Point2f> hull;
  cv::convexHull(footprint, hull);
  const int margin = static_cast<int>(3.0F * sigma_px) + 2;
  cv::Rect area = cv::boundingRect(hull);
  area = cv::Rect(area.x - margin, area.y - margin, area.width + 2 * margin, area.height + 2 * margin) &
         cv::Rect({0, 0}, layer.light.size());
  if (area.empty()) return;
  std::vector<cv::Point> polygon;
  for (const auto& p : hull) polygon.emplace_back(cvRound(p.x) - area.x, cvRound(p.y) - area.y);
  cv::Mat1f shadow(area.size(), 0.0F);
  cv::fillConvexPoly(shadow, polygon, cv::Scalar(strength));
  cv::GaussianBlur(shadow, shadow, {}, sigma_px);
  cv::Mat1f target = layer.light(area);
  target = target.mul(1.0F - shadow);
}

}  // namespace

std::array<Eigen::Vector3f, 8> Primitive::localCorners() const {
  Eigen::Vector3f low(-1, -1, -1), high(1, 1, 1);
  if (shape == Shape::kFrustum || shape == Shape::kRoundedCone) {
    const float radius = std::max(radius_start, radius_end);
    low.head<2>().setConstant(-radius);
    high.head<2>().setConstant(radius);
  }
  if (shape == Shape::kRoundedCone) {
    low.z() = std::min(-radius_start, length - radius_end);
    high.z() = std::max(radius_start, length + radius_end);
  }
  std::array<Eigen::Vector3f, 8> corners;
  for (int i = 0; i < 8; ++i) {
    corners[i] = {(i & 1) ? high.x() : low.x(), (i & 2) ? high.y() : low.y(), (i & 4) ? high.z() : low.z()};
  }
  return corners;
}

float ShadowLayer::at(float x_m, float y_m) const {
  const float x = std::clamp((x_m - origin_m.x()) * px_per_m, 0.0F, static_cast<float>(light.cols) - 1.001F);
  const float y = std::clamp((y_m - origin_m.y()) * px_per_m, 0.0F, static_cast<float>(light.rows) - 1.001F);
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const float dx = x - static_cast<float>(x0), dy = y - static_cast<float>(y0);
  const float* top = light.ptr<float>(y0) + x0;
  const float* bottom = light.ptr<float>(y0 + 1) + x0;
  return (top[0] * (1 - dx) + top[1] * dx) * (1 - dy) + (bottom[0] * (1 - dx) + bottom[1] * dx) * dy;
}

Primitive makeBox(const Eigen::Vector3f& center, const Eigen::Vector3f& size, int material, std::uint8_t label) {
  Primitive box;
  box.shape = Shape::kBox;
  box.T_world_local.translation() = center;
  box.scale = 0.5F * size;
  box.materials.fill(material);
  box.label = label;
  return box;
}

Primitive makeEllipsoid(const Eigen::Vector3f& center, const Eigen::Vector3f& radii, int material, std::uint8_t label) {
  Primitive ellipsoid = makeBox(center, 2.0F * radii, material, label);
  ellipsoid.shape = Shape::kEllipsoid;
  return ellipsoid;
}

Primitive makeFrustum(const Eigen::Vector3f& base, float radius_bottom_m, float radius_top_m, float height_m,
                      int material, std::uint8_t label) {
  Primitive frustum = makeBox(base + Eigen::Vector3f(0, 0, 0.5F * height_m), {2, 2, height_m}, material, label);
  frustum.shape = Shape::kFrustum;
  frustum.radius_start = radius_bottom_m;
  frustum.radius_end = radius_top_m;
  return frustum;
}

Primitive makeRoundedCone(const Eigen::Vector3f& from, float radius_from_m, const Eigen::Vector3f& to,
                          float radius_to_m, int material, std::uint8_t label, float squash,
                          const Eigen::Vector3f& squash_axis) {
  Primitive cone = makeBox(from, {2, 2, 2}, material, label);
  cone.shape = Shape::kRoundedCone;
  const Eigen::Vector3f axis = to - from;
  cone.length = std::max(axis.norm(), 1e-3F);
  const Eigen::Vector3f z = axis.norm() > 1e-3F ? Eigen::Vector3f(axis.normalized()) : Eigen::Vector3f::UnitZ();
  Eigen::Vector3f x = squash_axis - squash_axis.dot(z) * z;
  if (x.norm() < 1e-3F) x = z.unitOrthogonal();
  x.normalize();
  cone.T_world_local.linear() << x, z.cross(x), z;
  cone.scale = {squash, 1, 1};
  cone.radius_start = radius_from_m;
  cone.radius_end = radius_to_m;
  return cone;
}

Primitives placed(Primitives group, const Eigen::Isometry3f& T_world_group) {
  for (auto& primitive : group) primitive.T_world_local = T_world_group * primitive.T_world_local;
  return group;
}

void append(Primitives& all, const Primitives& more) { all.insert(all.end(), more.begin(), more.end()); }

void addShadowLayers(Scene& scene, const std::vector<int>& supports, int first) {
  constexpr float kHighestGapM = 1.2F;  // what hangs higher casts nothing one could see
  for (const int index : supports) {
    const Bounds support = worldBounds(scene.primitives[index]);
    ShadowLayer layer;
    layer.origin_m = support.low.head<2>();
    const Eigen::Vector2f size_px = (support.high - support.low).head<2>() * layer.px_per_m;
    layer.light = cv::Mat1f(static_cast<int>(size_px.y()) + 2, static_cast<int>(size_px.x()) + 2, 1.0F);
    for (std::size_t i = first; i < scene.primitives.size(); ++i) {
      const Bounds thing = worldBounds(scene.primitives[i]);
      const float gap_m = thing.low.z() - support.high.z();
      if (static_cast<int>(i) == index || gap_m < -0.02F || gap_m > kHighestGapM) continue;
      castOn(layer, scene.primitives[i], std::max(gap_m, 0.0F));
    }
    scene.primitives[index].shadow_layer = static_cast<int>(scene.shadow_layers.size());
    scene.shadow_layers.push_back(layer);
  }
}

}  // namespace semantic_vslam::synthetic
