// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "eval/synthetic/ray_caster.h"

#include <algorithm>
#include <array>
#include <utility>

#include "eval/synthetic/ray_target.h"
#include "eval/synthetic/shader.h"

namespace semantic_vslam::synthetic {
namespace {

using Eigen::Vector2f;

constexpr int kTilePx = 16;

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
