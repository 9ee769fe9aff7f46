// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "eval/synthetic/ray_caster.h"
#include "eval/synthetic/ray_target.h"

namespace semantic_vslam::synthetic {

struct SurfacePoint;

/// The light that comes back along a ray from what it hits.
class Shader {
 public:
  /// All are kept by reference. @param focal_px  of the camera: how wide a pixel is
  Shader(const Scene& scene, const std::vector<Target>& targets, const std::vector<FloorShadow>& floor_shadows,
         const Lighting& lighting, const SE3& T_world_camera, float focal_px);

  /// @return BGR, 0..255 and brighter
  cv::Vec3f shade(const Hit& hit, float ray_x, float ray_y) const;

 private:
  cv::Vec3f textureAt(const Primitive& p, const SurfacePoint& s, const Material& material, const Hit& hit,
                      const Eigen::Vector3f& normal, const Eigen::Vector3f& view) const;
  cv::Vec3f lightAt(const Primitive& p, const Material& material, const Eigen::Vector3f& point,
                    const Eigen::Vector3f& normal, const Eigen::Vector3f& view) const;
  float shadowAt(const Primitive& p, const Eigen::Vector3f& point, const Eigen::Vector3f& normal) const;

  const Scene& scene_;
  const std::vector<Target>& targets_;
  const std::vector<FloorShadow>& floor_shadows_;
  const Lighting& lighting_;
  const Eigen::Isometry3f T_world_camera_;
  const float pixel_rad_;
};

}  // namespace semantic_vslam::synthetic
