// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "eval/synthetic/texture.h"

namespace semantic_vslam::synthetic {

/// Class ids of the label images that the synthetic room renders.
enum Label : std::uint8_t {
  kBackground,
  kPerson,
  kChair,
  kMonitor,
  kKeyboard,
  kMouse,
  kBook,
  kLaptop,
  kBottle,
  kCup,
  kTable,
  kLabelCount
};

/// How a surface looks.
struct Material {
  int texture = 0;              ///< index into Scene::textures
  float repeat_m = 0.0F;        ///< metres that one texture spans; 0 = stretched once over the face
  cv::Vec3f tint{1, 1, 1};      ///< BGR factor
  float gloss = 0.0F;           ///< strength of the highlight, 0..1
  float emission = 0.0F;        ///< share of the colour that shines by itself, 0..1 (screens, lamps, windows)
  bool rotate_quarter = false;  ///< swaps u and v
};

enum class Shape : std::uint8_t {
  kBox,         ///< |x|, |y|, |z| <= 1
  kEllipsoid,   ///< x^2 + y^2 + z^2 <= 1
  kFrustum,     ///< z from -1 to 1, radius `radius_start` at the bottom and `radius_end` at the top
  kRoundedCone  ///< hull of a sphere radius_start at z = 0 and a sphere radius_end at z = length
};

/// One solid: a unit shape, scaled along its own axes and placed in the world.
struct Primitive {
  Shape shape = Shape::kBox;
  Eigen::Isometry3f T_world_local = Eigen::Isometry3f::Identity();
  Eigen::Vector3f scale = Eigen::Vector3f::Ones();  ///< metres per local unit, along x, y, z
  float radius_start = 1.0F, radius_end = 1.0F;     ///< local units; frustum and rounded cone
  float length = 1.0F;                              ///< local units; rounded cone
  /// Index into Scene::materials for the faces -x +x -y +y -z +z; other shapes use the first for the side,
  /// and frustums [4] and [5] for bottom and top.
  std::array<int, 6> materials{};
  std::uint8_t label = kBackground;
  bool moving = false;    ///< moves at the rendered time; set each frame
  int thing = -1;         ///< number of the thing in the scene that it is a part of; -1 = not numbered
  int shadow_layer = -1;  ///< index into Scene::shadow_layers for the upper face; -1 = none

  /// Corners of the bounding box in local units.
  std::array<Eigen::Vector3f, 8> localCorners() const;
  Eigen::Vector3f toWorld(const Eigen::Vector3f& local) const { return T_world_local * scale.cwiseProduct(local); }
};

/// Contact shadows on the upper face of a floor, table top or board, seen from above.
struct ShadowLayer {
  Eigen::Vector2f origin_m;  ///< world x, y of the centre of pixel (0, 0)
  float px_per_m = 50.0F;
  cv::Mat1f light;  ///< share of light that arrives, 0..1; rows along y, columns along x

  float at(float x_m, float y_m) const;
};

using Primitives = std::vector<Primitive>;

/// Everything that stands still, with the looks of everything that does not.
struct Scene {
  std::vector<Texture> textures;
  std::vector<Material> materials;
  std::vector<Primitive> primitives;
  std::vector<ShadowLayer> shadow_layers;
  int things = 0;  ///< numbered so far

  int addTexture(const cv::Mat3b& bgr) {
    textures.emplace_back(bgr);
    return static_cast<int>(textures.size()) - 1;
  }
  /// Gives all of a group's solids the next number of a thing.
  Primitives numbered(Primitives group) {
    for (Primitive& part : group) part.thing = things;
    ++things;
    return group;
  }
  int addMaterial(const Material& material) {
    materials.push_back(material);
    return static_cast<int>(materials.size()) - 1;
  }
};

/// @param center, size  metres, full side lengths, in the object's frame
Primitive makeBox(const Eigen::Vector3f& center, const Eigen::Vector3f& size, int material, std::uint8_t label);
Primitive makeEllipsoid(const Eigen::Vector3f& center, const Eigen::Vector3f& radii, int material, std::uint8_t label);
/// Upright (along z), from base upwards.
Primitive makeFrustum(const Eigen::Vector3f& base, float radius_bottom_m, float radius_top_m, float height_m,
                      int material, std::uint8_t label);
/// Hull of two spheres. @param squash  factor across the axis, along the local x that is nearest to `squash_axis`
Primitive makeRoundedCone(const Eigen::Vector3f& from, float radius_from_m, const Eigen::Vector3f& to,
                          float radius_to_m, int material, std::uint8_t label, float squash = 1.0F,
                          const Eigen::Vector3f& squash_axis = Eigen::Vector3f::UnitX());

/// Moves a group of primitives by a rigid motion.
Primitives placed(Primitives group, const Eigen::Isometry3f& T_world_group);
void append(Primitives& all, const Primitives& more);

/// Gives every upward face marked as support its contact shadows from what stands on or over it.
/// @param supports  indices into scene.primitives of boxes that stand upright
/// @param first     solids before this index cast nothing (they are in another room)
void addShadowLayers(Scene& scene, const std::vector<int>& supports, int first);

}  // namespace semantic_vslam::synthetic
