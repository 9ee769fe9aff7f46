// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "eval/synthetic/scene.h"
#include "semantic_vslam/core/camera/camera_model.h"
#include "semantic_vslam/core/geometry/se3.h"

namespace semantic_vslam::synthetic {

/// A soft lamp: its light falls off with distance and reaches a little round the edge.
struct PointLight {
  Eigen::Vector3f position_m = {0, 0, 2.4F};
  cv::Vec3f color{0.7F, 0.7F, 0.7F};  ///< BGR strength at reach_m / 2
  float reach_m = 3.0F;
  Eigen::Vector2f low_m{-1e6F, -1e6F}, high_m{1e6F, 1e6F};  ///< world x, y of the room it lights: walls are opaque

  bool reaches(const Eigen::Vector3f& point) const {
    return (point.head<2>().array() >= low_m.array()).all() && (point.head<2>().array() <= high_m.array()).all();
  }
};

struct Lighting {
  std::vector<PointLight> lamps;
  cv::Vec3f ambient{0.45F, 0.45F, 0.45F};  ///< BGR
};

/// Soft dark spot on the floor under something that moves.
struct FloorShadow {
  Eigen::Vector2f center_m;
  float radius_m = 0.2F;
  float strength = 0.4F;
};

/// What an ideal camera sees.
struct Rendering {
  cv::Mat3b bgr;        ///< anti-aliased
  cv::Mat1f depth_m;    ///< z of the surface at the pixel's centre, 0 = nothing there
  cv::Mat1i primitive;  ///< index of the solid at the pixel's centre, -1 = none
};

/// Casts one ray a pixel through a scene of solids. Solids are sorted into tiles of the image first, and pixels on an
/// outline get four more rays, against the solids of their neighbourhood only.
class RayCaster {
 public:
  explicit RayCaster(std::shared_ptr<const CameraModel> camera);

  /// @param scene   looks; the solids in it are followed by `moving`
  /// @param moving  solids at the time of the frame; their indices go on after those of the scene
  Rendering render(const Scene& scene, const Primitives& moving, const std::vector<FloorShadow>& floor_shadows,
                   const Lighting& lighting, const SE3& T_world_camera) const;

  const std::shared_ptr<const CameraModel>& camera() const { return camera_; }

 private:
  struct Tile {
    cv::Rect area;                      // px
    Eigen::Vector2f ray_low, ray_high;  // x/z and y/z that its pixels span
  };
  std::shared_ptr<const CameraModel> camera_;
  std::vector<Tile> tiles_;
};

}  // namespace semantic_vslam::synthetic
