// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "eval/synthetic/workshop.h"

#include <cmath>

#include "eval/synthetic/patterns.h"

namespace semantic_vslam::synthetic {
namespace {

using Eigen::Vector3f;

constexpr float kPi = static_cast<float>(M_PI);

Eigen::Isometry3f tilted(const Eigen::Isometry3f& T, float pitch_rad) {
  return T * Eigen::Isometry3f(Eigen::AngleAxisf(pitch_rad, Vector3f::UnitY()));
}

}  // namespace

Eigen::Isometry3f pose(float x_m, float y_m, float z_m, float yaw_rad) {
  Eigen::Isometry3f T = Eigen::Isometry3f::Identity();
  T.translation() = Vector3f(x_m, y_m, z_m);
  T.linear() = Eigen::AngleAxisf(yaw_rad, Vector3f::UnitZ()).toRotationMatrix();
  return T;
}

Workshop::Workshop(Scene& scene, Rng& rng) : scene_(scene), rng_(rng), desk_height_m_(between(0.70, 0.76)) {
  const cv::Scalar wood_tones[] = {{95, 140, 185}, {60, 95, 140}, {150, 190, 215}, {45, 65, 95}, {190, 200, 205}};
  for (int i = 0; i < 3; ++i) woods_.push_back(paint(wood(wood_tones[rng_.below(5)], rng_), 0.8F, 0.12F));
  for (const double value : {40.0, 75.0, 215.0}) {
    plastics_.push_back(paint(plastic(cv::Scalar::all(value), rng_), 0.15F, 0.15F));
  }
  plastics_.push_back(paint(plastic(randomColor(rng_, 90, 220, 90, 220), rng_), 0.15F, 0.15F));
  for (const double value : {130.0, 185.0}) {
    metals_.push_back(paint(plastic(cv::Scalar::all(value), rng_), 0.1F, 0.5F));
  }
  fabrics_ = {paint(plainCloth(randomColor(rng_, 60, 200, 40, 160), rng_), 0.5F),
              paint(plaid(randomColor(rng_, 40, 160, 60, 190), rng_), 0.5F),
              paint(carpet(randomColor(rng_, 20, 160, 50, 150), rng_), 0.6F)};
  for (int i = 0; i < 10; ++i) {
    spines_.push_back(paint(bookSpine(rng_), 0.0F, 0.05F));
    scene_.materials.back().rotate_quarter = true;
  }
  for (int i = 0; i < 6; ++i) covers_.push_back(paint(bookCover(rng_), 0.0F, 0.08F));
  for (int i = 0; i < 3; ++i) leaves_.push_back(paint(leaf(rng_), 0.0F, 0.1F));
  for (int i = 0; i < 3; ++i) pages_.push_back(paint(printedPage(rng_), 0.0F));
  page_edges_ = paint(pageEdges(rng_), 0.04F);
  soil_ = paint(soil(rng_), 0.1F);
}

int Workshop::paint(const cv::Mat3b& texture, float repeat_m, float gloss, float emission) {
  Material material;
  material.texture = scene_.addTexture(texture);
  material.repeat_m = repeat_m;
  material.gloss = gloss;
  material.emission = emission;
  return scene_.addMaterial(material);
}

Primitives Workshop::desk(float width_m, float depth_m) {
  const int top = anyOf(woods_), leg = rng_.below(2) ? anyOf(metals_) : top;
  const float h = desk_height_m_, thickness = between(0.022, 0.04);
  Primitives parts{makeBox({0, 0, h - thickness / 2}, {depth_m, width_m, thickness}, top, kTable)};
  const float x = depth_m / 2 - 0.05F, y = width_m / 2 - 0.05F;
  if (rng_.below(2) == 0) {  // panels at the sides, drawers under one
    for (const float side : {-1.0F, 1.0F}) {
      parts.push_back(
          makeBox({0, side * y, (h - thickness) / 2}, {depth_m - 0.08F, 0.03F, h - thickness}, top, kTable));
    }
    for (int drawer = 0; drawer < 3; ++drawer) {
      const float z = 0.12F + 0.2F * static_cast<float>(drawer);
      parts.push_back(makeBox({0.03F, y - 0.23F, z}, {depth_m - 0.16F, 0.38F, 0.19F}, top, kTable));
      parts.push_back(makeBox({-depth_m / 2 + 0.1F, y - 0.23F, z + 0.04F}, {0.02F, 0.12F, 0.015F}, metals_[0], kTable));
    }
  } else {
    for (const float sx : {-1.0F, 1.0F}) {
      for (const float sy : {-1.0F, 1.0F}) {
        parts.push_back(makeBox({sx * x, sy * y, (h - thickness) / 2}, {0.05F, 0.05F, h - thickness}, leg, kTable));
      }
    }
    parts.push_back(makeBox({x, 0, h - 0.2F}, {0.02F, 2 * y, 0.3F}, top, kTable));
  }
  return parts;
}

Primitives Workshop::roundTable(float radius_m) {
  const int top = anyOf(woods_), foot = anyOf(metals_);
  return {makeFrustum({0, 0, desk_height_m_ - 0.03F}, radius_m, radius_m, 0.03F, top, kTable),
          makeFrustum({0, 0, 0.03F}, 0.05F, 0.04F, desk_height_m_ - 0.06F, foot, kTable),
          makeFrustum({0, 0, 0}, 0.6F * radius_m, 0.08F, 0.04F, foot, kTable)};
}

Primitives Workshop::officeChair() {
  const int cloth = anyOf(fabrics_), frame = rng_.below(3) ? plastics_[0] : metals_[0];
  const float seat_z = between(0.44, 0.50), width = between(0.44, 0.52), back_h = between(0.40, 0.68);
  Primitives parts;
  for (int i = 0; i < 5; ++i) {
    const float angle = 2.0F * kPi * static_cast<float>(i) / 5.0F;
    const Vector3f tip(0.29F * std::cos(angle), 0.29F * std::sin(angle), 0.07F);
    parts.push_back(makeRoundedCone({0, 0, 0.11F}, 0.03F, tip, 0.018F, frame, kChair));
    parts.push_back(makeEllipsoid(tip - Vector3f(0, 0, 0.037F), {0.03F, 0.03F, 0.03F}, plastics_[0], kChair));
  }
  parts.push_back(makeFrustum({0, 0, 0.1F}, 0.03F, 0.022F, seat_z - 0.14F, metals_[0], kChair));
  // Seat and back are capsules pressed flat.
  parts.push_back(makeRoundedCone({0, -0.06F, seat_z - 0.04F}, width * 0.46F, {0, 0.06F, seat_z - 0.04F}, width * 0.46F,
                                  cloth, kChair, 0.20F, Vector3f::UnitZ()));
  // The user looks along +x when seated, so the back is at -x.
  parts.push_back(
      makeRoundedCone({-0.18F, 0, seat_z - 0.06F}, 0.025F, {-0.26F, 0, seat_z + 0.22F}, 0.02F, frame, kChair));
  const float back_r = width * 0.46F, rise = std::max(back_h - 2 * back_r, 0.03F);
  Primitives back{makeRoundedCone({0, 0, back_r}, back_r, {0, 0, back_r + rise}, 0.92F * back_r, cloth, kChair, 0.16F)};
  append(parts, placed(back, tilted(pose(-0.24F, 0, seat_z + 0.1F, 0), -0.16F)));
  if (rng_.below(3)) {
    for (const float side : {-1.0F, 1.0F}) {
      const float y = side * (width / 2 + 0.03F);
      parts.push_back(makeBox({0.0F, y, seat_z + 0.2F}, {0.26F, 0.06F, 0.03F}, plastics_[0], kChair));
      parts.push_back(makeBox({-0.03F, y, seat_z + 0.08F}, {0.04F, 0.025F, 0.24F}, plastics_[0], kChair));
    }
  }
  return parts;
}

Primitives Workshop::woodenChair() {
  const int timber = anyOf(woods_), seat = rng_.below(2) ? timber : anyOf(fabrics_);
  const float seat_z = between(0.43, 0.47), half = between(0.18, 0.21), back_h = between(0.36, 0.5);
  Primitives parts{makeBox({0, 0, seat_z - 0.015F}, {2 * half + 0.04F, 2 * half + 0.04F, 0.03F}, seat, kChair)};
  for (const float sx : {-1.0F, 1.0F}) {
    for (const float sy : {-1.0F, 1.0F}) {
      parts.push_back(makeBox({sx * half, sy * half, seat_z / 2}, {0.035F, 0.035F, seat_z}, timber, kChair));
    }
  }
  for (const float side : {-1.0F, 1.0F}) {
    parts.push_back(makeRoundedCone({-half, side * half, seat_z}, 0.018F, {-half - 0.07F, side * half, seat_z + back_h},
                                    0.016F, timber, kChair));
  }
  if (rng_.below(2)) {
    for (int slat = 0; slat < 3; ++slat) {
      const float rise = (0.3F + 0.3F * static_cast<float>(slat)) * back_h;
      parts.push_back(
          makeBox({-half - 0.07F * rise / back_h, 0, seat_z + rise}, {0.018F, 2 * half, 0.07F}, timber, kChair));
    }
  } else {
    Primitives panel{makeBox({0, 0, 0.6F * back_h}, {0.025F, 2 * half, 0.55F * back_h}, seat, kChair)};
    append(parts, placed(panel, tilted(pose(-half, 0, seat_z, 0), -0.14F)));
  }
  return parts;
}

Primitives Workshop::shelf(float width_m, float height_m) {
  constexpr float kDepth = 0.30F, kBoard = 0.022F;
  const int timber = anyOf(woods_);
  Primitives parts{makeBox({kDepth / 2 - 0.01F, 0, height_m / 2}, {0.015F, width_m, height_m}, timber, kBackground)};
  for (const float side : {-1.0F, 1.0F}) {
    parts.push_back(
        makeBox({0, side * (width_m - kBoard) / 2, height_m / 2}, {kDepth, kBoard, height_m}, timber, kBackground));
  }
  const int boards = std::max(2, static_cast<int>(height_m / 0.36F));
  const float spacing = (height_m - kBoard) / static_cast<float>(boards);
  for (int i = 0; i <= boards; ++i) {
    const float z = kBoard / 2 + spacing * static_cast<float>(i);
    parts.push_back(makeBox({0, 0, z}, {kDepth - 0.01F, width_m - 2 * kBoard, kBoard}, timber, kBackground));
    if (i == boards) break;
    const float floor_z = z + kBoard / 2;
    float y = width_m / 2 - kBoard - 0.01F;
    while (y > -width_m / 2 + 0.12F) {
      if (rng_.below(12) == 0) {  // something else between the books
        const Primitives thing = rng_.below(2) ? carton({0.2F, 0.22F, 0.2F}) : cup();
        append(parts, placed(thing, pose(-0.02F, y - 0.12F, floor_z, 0)));
        y -= 0.26F;
        continue;
      }
      const float thick = between(0.018, 0.052), tall = between(0.6, 0.88) * (spacing - kBoard),
                  deep = between(0.15, 0.22);
      Primitive book = makeBox({-kDepth / 2 + deep / 2 + between(0.01, 0.03), y - thick / 2, floor_z + tall / 2},
                               {deep, thick, tall}, anyOf(covers_), kBook);
      book.materials[0] = anyOf(spines_);
      book.materials[5] = page_edges_;
      parts.push_back(book);
      y -= thick + (rng_.below(9) == 0 ? between(0.02, 0.15) : 0.002F);
    }
  }
  return parts;
}

Primitives Workshop::cabinet(float width_m, float height_m) {
  constexpr float kDepth = 0.42F;
  const int body = rng_.below(2) ? anyOf(woods_) : anyOf(plastics_), handle = metals_[1];
  Primitives parts{makeBox({0, 0, height_m / 2}, {kDepth, width_m, height_m}, body, kBackground)};
  const int rows = std::max(1, static_cast<int>(height_m / 0.32F));
  for (int row = 0; row < rows; ++row) {
    const float h = height_m / static_cast<float>(rows), z = (static_cast<float>(row) + 0.5F) * h;
    parts.push_back(makeBox({-kDepth / 2 - 0.008F, 0, z}, {0.016F, width_m - 0.03F, h - 0.03F}, body, kBackground));
    parts.push_back(makeBox({-kDepth / 2 - 0.03F, 0, z + 0.05F}, {0.02F, 0.14F, 0.014F}, handle, kBackground));
    Primitive tag =
        makeBox({-kDepth / 2 - 0.017F, 0.2F * width_m, z + 0.05F}, {0.002F, 0.12F, 0.06F}, anyOf(pages_), kBackground);
    parts.push_back(tag);
  }
  return parts;
}

Primitives Workshop::plant(float height_m) {
  const float pot_h = 0.28F * height_m, pot_r = between(0.10, 0.15) * height_m;
  const int pot = paint(cupPrint(randomColor(rng_, 20, 180, 90, 220), rng_), 0.4F, 0.1F);
  Primitives parts{makeFrustum({0, 0, 0}, 0.75F * pot_r, pot_r, pot_h, pot, kBackground)};
  parts.back().materials[5] = soil_;
  const int stems = 7 + static_cast<int>(rng_.below(5));
  for (int i = 0; i < stems; ++i) {
    const float angle = between(0, 2 * M_PI), lean = between(0.1, 0.75),
                length = between(0.5, 0.95) * (height_m - pot_h);
    const Vector3f direction(std::sin(lean) * std::cos(angle), std::sin(lean) * std::sin(angle), std::cos(lean));
    const Vector3f base(0, 0, pot_h - 0.02F), tip = base + length * direction;
    parts.push_back(makeRoundedCone(base, 0.008F, tip, 0.004F, leaves_[0], kBackground));
    for (int k = 0; k < 3; ++k) {
      const float size = between(0.10, 0.16) * height_m;
      Primitive blade = makeEllipsoid(Vector3f::Zero(), {size, 0.36F * size, 0.006F}, anyOf(leaves_), kBackground);
      Eigen::Isometry3f T = pose(0, 0, 0, angle + between(-1.4, 1.4));
      T.linear() = T.linear() * Eigen::AngleAxisf(between(-0.5, 0.9), Vector3f::UnitY()).toRotationMatrix();
      T.translation() = base + (tip - base) * between(0.45, 1.0) + T.linear() * Vector3f(0.8F * size, 0, 0);
      blade.T_world_local = T;
      parts.push_back(blade);
    }
  }
  return parts;
}

Primitives Workshop::floorLamp() {
  const int shade = paint(plainCloth({190, 225, 240}, rng_), 0.4F, 0.0F, 0.55F);
  const float h = between(1.35, 1.65);
  return {makeFrustum({0, 0, 0}, 0.14F, 0.13F, 0.03F, metals_[0], kBackground),
          makeFrustum({0, 0, 0.02F}, 0.012F, 0.012F, h - 0.1F, metals_[0], kBackground),
          makeFrustum({0, 0, h - 0.2F}, 0.19F, 0.12F, 0.26F, shade, kBackground)};
}

Primitives Workshop::carton(const Vector3f& size_m) {
  return {makeBox({0, 0, size_m.z() / 2}, size_m, paint(synthetic::carton(rng_), 0.0F), kBackground)};
}

Primitives Workshop::monitor() {
  const float width = between(0.46, 0.62), height = width * between(0.56, 0.66), lift = between(0.10, 0.18);
  Primitive panel = makeBox({0, 0, height / 2}, {0.035F, width, height}, plastics_[0], kMonitor);
  panel.materials[0] = paint(screen(rng_), 0.0F, 0.1F, 0.8F);
  Primitives parts = placed({panel}, tilted(pose(0, 0, lift, 0), between(0.02, 0.12)));
  parts.push_back(makeBox({0.06F, 0, (lift + 0.12F) / 2}, {0.03F, 0.07F, lift + 0.12F}, plastics_[0], kMonitor));
  parts.push_back(makeBox({0.03F, 0, 0.008F}, {0.20F, 0.25F, 0.016F}, plastics_[0], kMonitor));
  return parts;
}

Primitives Workshop::keyboard() {
  Primitive body = makeBox({0, 0, 0.012F}, {between(0.13, 0.17), between(0.40, 0.46), 0.024F}, plastics_[0], kKeyboard);
  body.materials[5] = paint(keyboardKeys(rng_), 0.0F, 0.05F);
  return {body};
}

Primitives Workshop::mouse() {
  return {makeEllipsoid({0, 0, 0.008F}, {0.058F, 0.034F, 0.028F}, anyOf(plastics_), kMouse)};
}

Primitives Workshop::laptop() {
  const float width = between(0.31, 0.37), depth = between(0.21, 0.25);
  const int shell = rng_.below(2) ? plastics_[0] : metals_[1];
  Primitive base = makeBox({0, 0, 0.01F}, {depth, width, 0.02F}, shell, kLaptop);
  base.materials[5] = paint(keyboardKeys(rng_), 0.0F, 0.05F);
  Primitive lid = makeBox({0, 0, depth * 0.47F}, {0.01F, width, depth * 0.94F}, shell, kLaptop);
  lid.materials[0] = paint(screen(rng_), 0.0F, 0.1F, 0.75F);
  Primitives parts{base};
  append(parts, placed({lid}, tilted(pose(depth / 2, 0, 0.02F, 0), between(0.15, 0.4))));
  return parts;
}

Primitives Workshop::bottle() {
  const float r = between(0.030, 0.042), body = between(0.13, 0.19);
  const int look = paint(bottleLabel(randomColor(rng_, 60, 220, 60, 210), rng_), 0.0F, 0.5F);
  return {makeFrustum({0, 0, 0}, r, r, body, look, kBottle),
          makeFrustum({0, 0, body}, r, 0.4F * r, 0.05F, anyOf(plastics_), kBottle),
          makeFrustum({0, 0, body + 0.05F}, 0.4F * r, 0.4F * r, 0.035F, plastics_[3], kBottle)};
}

Primitives Workshop::cup() {
  const float r = between(0.036, 0.046), h = between(0.08, 0.105);
  const int look = paint(cupPrint(randomColor(rng_, 20, 220, 110, 240), rng_), 0.0F, 0.3F);
  const int coffee = plastics_[0];
  Primitives parts{makeFrustum({0, 0, 0}, 0.85F * r, r, h, look, kCup)};
  parts.back().materials[5] = coffee;
  const float y = 0.95F * r;
  const Vector3f low(0, y, 0.25F * h), mid_low(0, y + 0.025F, 0.35F * h), mid_high(0, y + 0.025F, 0.68F * h),
      high(0, y, 0.8F * h);
  parts.push_back(makeRoundedCone(low, 0.006F, mid_low, 0.006F, look, kCup));
  parts.push_back(makeRoundedCone(mid_low, 0.006F, mid_high, 0.006F, look, kCup));
  parts.push_back(makeRoundedCone(mid_high, 0.006F, high, 0.006F, look, kCup));
  return parts;
}

Primitives Workshop::bookPile(int count) {
  Primitives parts;
  float z = 0.0F;
  for (int i = 0; i < count; ++i) {
    const float thick = between(0.018, 0.045), wide = between(0.15, 0.21), tall = between(0.21, 0.29);
    Primitive book = makeBox({0, 0, thick / 2}, {wide, tall, thick}, page_edges_, kBook);
    book.materials[4] = book.materials[5] = anyOf(covers_);
    Material spine = scene_.materials[anyOf(spines_)];
    spine.rotate_quarter = false;
    book.materials[0] = scene_.addMaterial(spine);
    append(parts, placed({book}, pose(between(-0.015, 0.015), between(-0.02, 0.02), z, between(-0.25, 0.25))));
    z += thick;
  }
  return parts;
}

Primitives Workshop::papers() {
  Primitives parts;
  for (int i = 0; i < 3; ++i) {
    Primitive sheet = makeBox({0, 0, 0.001F}, {0.29F, 0.21F, 0.002F}, anyOf(pages_), kBackground);
    append(parts, placed({sheet}, pose(between(-0.05, 0.05), between(-0.1, 0.1), 0.002F * static_cast<float>(i),
                                       between(-0.6, 0.6))));
  }
  return parts;
}

Primitives Workshop::penHolder() {
  Primitives parts{makeFrustum({0, 0, 0}, 0.035F, 0.038F, 0.1F, anyOf(plastics_), kBackground)};
  for (int i = 0; i < 5; ++i) {
    const Vector3f base(between(-0.02, 0.02), between(-0.02, 0.02), 0.08F);
    const Vector3f tip = base + Vector3f(between(-0.03, 0.03), between(-0.03, 0.03), between(0.07, 0.11));
    parts.push_back(makeRoundedCone(base, 0.004F, tip, 0.004F, anyOf(plastics_), kBackground));
  }
  return parts;
}

Primitives Workshop::deskLamp() {
  const int body = anyOf(plastics_);
  const Vector3f elbow(0.12F, 0, 0.26F), head(-0.06F, 0, 0.42F);
  return {makeFrustum({0, 0, 0}, 0.08F, 0.075F, 0.02F, body, kBackground),
          makeRoundedCone({0, 0, 0.02F}, 0.010F, elbow, 0.010F, metals_[0], kBackground),
          makeRoundedCone(elbow, 0.010F, head, 0.010F, metals_[0], kBackground),
          makeFrustum(head - Vector3f(0, 0, 0.06F), 0.08F, 0.03F, 0.09F, body, kBackground)};
}

Primitives Workshop::wallPicture(float width_m, float height_m) {
  const bool wide = width_m > height_m;
  const cv::Size size = wide ? cv::Size(512, 256) : cv::Size(256, 512);
  Primitive sheet = makeBox({-0.006F, 0, 0}, {0.012F, width_m, height_m}, plastics_[0], kBackground);
  sheet.materials[0] = paint(rng_.below(3) ? poster(size, rng_) : painting(size, rng_), 0.0F, 0.03F);
  return {sheet};
}

Primitives Workshop::wallBoard(float width_m, float height_m) {
  Primitive board = makeBox({-0.01F, 0, 0}, {0.02F, width_m, height_m}, metals_[1], kBackground);
  board.materials[0] = paint(whiteboard(rng_), 0.0F, 0.2F);
  return {board, makeBox({-0.05F, 0, -height_m / 2}, {0.08F, 0.6F * width_m, 0.015F}, metals_[1], kBackground)};
}

Primitives Workshop::window(float width_m, float height_m) {
  Primitive pane = makeBox({-0.01F, 0, 0}, {0.02F, width_m, height_m}, plastics_[2], kBackground);
  pane.materials[0] = paint(windowView(rng_), 0.0F, 0.05F, 0.85F);
  return {pane,
          makeBox({-0.07F, 0, -height_m / 2 - 0.02F}, {0.14F, width_m + 0.1F, 0.035F}, plastics_[2], kBackground)};
}

Primitives Workshop::door(float width_m, float height_m) {
  Primitive leaf = makeBox({-0.015F, 0, 0}, {0.03F, width_m, height_m}, woods_[0], kBackground);
  leaf.materials[0] = paint(
      synthetic::door(
          colorFrom({{85, 125, 170}, {215, 220, 222}, {150, 152, 155}, {60, 85, 120}, {150, 120, 90}}, rng_), rng_),
      0.0F, 0.05F);
  return {leaf};
}

}  // namespace semantic_vslam::synthetic
