// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <vector>

#include "core/common/rng.h"
#include "eval/synthetic/scene.h"

namespace semantic_vslam::synthetic {

/// Makes furniture and small things, each a little different, and adds their looks to the scene.
///
/// Every object stands on z = 0 around the origin of its own frame, in metres; its front (the side its user is on)
/// looks along -x, y is to the user's left, z up.
class Workshop {
 public:
  /// @param scene  gets textures and materials; must outlive the workshop
  Workshop(Scene& scene, Rng& rng);

  Primitives desk(float width_m, float depth_m);
  Primitives roundTable(float radius_m);
  Primitives officeChair();
  Primitives woodenChair();
  Primitives shelf(float width_m, float height_m);
  Primitives cabinet(float width_m, float height_m);
  Primitives plant(float height_m);
  Primitives floorLamp();
  Primitives carton(const Eigen::Vector3f& size_m);

  Primitives monitor();
  Primitives keyboard();
  Primitives mouse();
  Primitives laptop();
  Primitives bottle();
  Primitives cup();
  Primitives bookPile(int count);
  Primitives papers();
  Primitives penHolder();
  Primitives deskLamp();

  /// Flat things on a wall: the wall is the plane x = 0, they stick out a little towards -x; the origin is their
  /// middle.
  Primitives wallPicture(float width_m, float height_m);
  Primitives wallBoard(float width_m, float height_m);
  Primitives window(float width_m, float height_m);
  Primitives door(float width_m, float height_m);

  /// Height of the desks this workshop makes.
  float deskHeight() const { return desk_height_m_; }

  int paint(const cv::Mat3b& texture, float repeat_m, float gloss = 0.0F, float emission = 0.0F);
  Rng& rng() { return rng_; }

 private:
  float between(double low, double high) { return static_cast<float>(rng_.uniform(low, high)); }
  int anyOf(const std::vector<int>& materials) { return materials[rng_.below(materials.size())]; }

  Scene& scene_;
  Rng& rng_;
  float desk_height_m_;
  std::vector<int> woods_, plastics_, metals_, fabrics_, spines_, covers_, leaves_, pages_;
  int page_edges_ = 0, soil_ = 0;
};

/// Turn about z, then shift.
Eigen::Isometry3f pose(float x_m, float y_m, float z_m, float yaw_rad);

}  // namespace semantic_vslam::synthetic
