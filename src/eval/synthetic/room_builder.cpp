// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "eval/synthetic/room_builder.h"

#include <algorithm>
#include <cmath>

#include "core/common/rng.h"
#include "eval/synthetic/patterns.h"
#include "eval/synthetic/workshop.h"

namespace semantic_vslam::synthetic {
namespace {

using Eigen::Isometry3f;
using Eigen::Vector3f;

constexpr float kPi = static_cast<float>(M_PI);
constexpr float kDoorWidthM = 1.1F, kDoorHeightM = 2.1F;
constexpr float kSlotM = 1.75F;  // length of wall for one piece of furniture

class RoomBuilder {
 public:
  RoomBuilder(const RoomSpec& spec, Scene& scene)
      : spec_(spec), scene_(scene), rng_(spec.look_seed), shift_rng_(spec.shift_seed), workshop_(scene, rng_) {}

  std::vector<PointLight> build() {
    first_ = static_cast<int>(scene_.primitives.size());
    buildShell();
    const bool bare = spec_.furnishing == Furnishing::kWallOnly;
    for (const Side side : {Side::kPlusX, Side::kPlusY, Side::kMinusX, Side::kMinusY}) {
      bare ? paperWall(side) : furnishWall(side);
    }
    if (spec_.furnishing == Furnishing::kMeeting) addMeetingTable();
    addShadows();
    return addLamps();
  }

 private:
  float between(double low, double high) { return static_cast<float>(rng_.uniform(low, high)); }
  float wallLength(Side side) const {
    return static_cast<float>(side == Side::kPlusX || side == Side::kMinusX ? spec_.size_m.y() : spec_.size_m.x());
  }

  /// Frame on a wall: the origin on the floor at the wall's middle, +x into the wall, y along it.
  Isometry3f wallFrame(Side side) const {
    const auto turn = static_cast<float>(static_cast<int>(side)) * kPi / 2;
    const bool along_x = side == Side::kPlusX || side == Side::kMinusX;
    const auto reach = static_cast<float>((along_x ? spec_.size_m.x() : spec_.size_m.y()) / 2);
    const auto cx = static_cast<float>(spec_.center_m.x()), cy = static_cast<float>(spec_.center_m.y());
    return pose(cx, cy, 0, turn) * pose(reach, 0, 0, 0);
  }

  /// Middles of the doorways in a wall, along the wall frame's y.
  std::vector<float> openings(Side side) const {
    std::vector<float> middles;
    for (const auto& doorway : spec_.doorways) {
      // Wall frame y is world +y for +x, -x for +y, -y for -x, +x for -y.
      const bool reversed = side == Side::kPlusY || side == Side::kMinusX;
      if (doorway.side == side) middles.push_back(static_cast<float>(reversed ? -doorway.offset_m : doorway.offset_m));
    }
    std::sort(middles.begin(), middles.end());
    return middles;
  }

  bool clearOfDoors(Side side, float y, float half_width) const {
    const auto middles = openings(side);
    return std::none_of(middles.begin(), middles.end(),
                        [&](float middle) { return std::abs(middle - y) < half_width + kDoorWidthM / 2 + 0.15F; });
  }

  void add(const Primitives& parts, const Isometry3f& T) {
    append(scene_.primitives, placed(scene_.numbered(parts), T));
  }
  /// Adds a support (a thing with its upper face first) and remembers it for contact shadows.
  void addSupport(const Primitives& parts, const Isometry3f& T) {
    supports_.push_back(static_cast<int>(scene_.primitives.size()));
    add(parts, T);
  }

  cv::Mat3b wallTexture() {
    const cv::Scalar color = colorFrom({{225, 228, 228},
                                        {195, 220, 232},
                                        {222, 212, 190},
                                        {192, 212, 190},
                                        {185, 200, 228},
                                        {205, 205, 208},
                                        {150, 190, 205},
                                        {200, 175, 150}},
                                       rng_);
    switch (rng_.below(5)) {
      case 0:
        return brickWall(colorFrom({{75, 90, 150}, {110, 145, 185}, {195, 203, 208}, {120, 122, 126}}, rng_), rng_);
      case 1: return wallpaper(color, rng_);
      default: return paintedWall(color, rng_);
    }
  }

  cv::Mat3b floorTexture() {
    switch (rng_.below(3)) {
      case 0: return woodFloor(colorFrom({{90, 130, 172}, {62, 92, 132}, {125, 165, 198}, {48, 68, 98}}, rng_), rng_);
      case 1:
        return carpet(colorFrom({{110, 110, 112}, {125, 105, 88}, {120, 150, 170}, {70, 90, 75}, {65, 60, 110}}, rng_),
                      rng_);
      default:
        return floorTiles(colorFrom({{170, 190, 205}, {165, 165, 168}, {205, 210, 212}, {95, 125, 175}}, rng_), rng_);
    }
  }

  void buildShell() {
    const auto w = static_cast<float>(spec_.size_m.x()), d = static_cast<float>(spec_.size_m.y()),
               h = static_cast<float>(spec_.size_m.z()), thick = static_cast<float>(kWallThicknessM);
    const Isometry3f T = pose(static_cast<float>(spec_.center_m.x()), static_cast<float>(spec_.center_m.y()), 0, 0);
    const int floor = workshop_.paint(floorTexture(), between(1.0, 1.5), 0.08F);
    const int ceiling = workshop_.paint(ceilingPanels(rng_), 1.25F);
    addSupport({makeBox({0, 0, -thick / 2}, {w + 2 * thick, d + 2 * thick, thick}, floor, kBackground)}, T);
    add({makeBox({0, 0, h + thick / 2}, {w + 2 * thick, d + 2 * thick, thick}, ceiling, kBackground)}, T);
    const int main_wall = workshop_.paint(wallTexture(), between(1.1, 1.5));
    const int accent_wall = workshop_.paint(wallTexture(), between(1.1, 1.5));
    for (const Side side : {Side::kPlusX, Side::kPlusY, Side::kMinusX, Side::kMinusY}) {
      buildWall(side, side == Side::kPlusY ? accent_wall : main_wall, h, thick);
    }
  }

  /// A wall of boxes left, right and above of its doorways, with a skirting board.
  void buildWall(Side side, int material, float height, float thick) {
    const Isometry3f T = wallFrame(side);
    const float half = wallLength(side) / 2 + thick;
    const int board = workshop_.paint(plastic(cv::Scalar::all(between(120, 230)), rng_), 0.2F);
    float from = -half;
    std::vector<float> middles = openings(side);
    middles.push_back(half + kDoorWidthM / 2);  // the wall's end closes the last piece
    for (const float middle : middles) {
      const float to = std::min(middle - kDoorWidthM / 2, half);
      if (to > from) {
        add({makeBox({thick / 2, (from + to) / 2, height / 2}, {thick, to - from, height}, material, kBackground),
             makeBox({-0.006F, (from + to) / 2, 0.04F}, {0.012F, to - from, 0.08F}, board, kBackground)},
            T);
      }
      from = middle + kDoorWidthM / 2;
      if (from < half) {
        add({makeBox({thick / 2, middle, (height + kDoorHeightM) / 2}, {thick, kDoorWidthM, height - kDoorHeightM},
                     material, kBackground)},
            T);
      }
    }
  }

  void furnishWall(Side side) {
    const Isometry3f T = wallFrame(side);
    const float usable = wallLength(side) - 0.5F;  // corners stay free for plants and lamps
    const int slots = static_cast<int>(usable / kSlotM);
    const float step = usable / static_cast<float>(slots);
    const bool desks = side == Side::kPlusX;
    std::vector<float> taken;  // middles of the slots with furniture
    for (int i = 0; i < slots; ++i) {
      const float y = (static_cast<float>(i) + 0.5F) * step - usable / 2;
      const float shift = static_cast<float>(shift_rng_.uniform(-1, 1) * spec_.shift_m);
      if (!clearOfDoors(side, y, kSlotM / 2)) continue;
      furnishSlot(T * pose(0, y + shift, 0, 0), desks ? 0 : rng_.below(6));
      taken.push_back(y + shift);
    }
    fillGaps(side, taken);
    const float corner = wallLength(side) / 2 - 0.3F;
    if (clearOfDoors(side, corner, 0.3F)) {
      add(rng_.below(3) ? workshop_.plant(between(0.8, 1.4)) : workshop_.floorLamp(), T * pose(-0.32F, corner, 0, 0));
    }
  }

  /// One piece of wall with furniture; the frame stands at the wall.
  void furnishSlot(const Isometry3f& T, std::uint64_t kind) {
    switch (kind) {
      case 0:
      case 1: addDesk(T); break;
      case 2:
        add(workshop_.shelf(between(0.9, 1.5), between(1.7, 2.1)), T * pose(-0.17F, between(-0.1, 0.1), 0, 0));
        break;
      case 3: addCabinet(T); break;
      case 4: add(workshop_.door(0.9F, kDoorHeightM), T * pose(0, 0, kDoorHeightM / 2, 0)); break;
      default:
        add(workshop_.woodenChair(), T * pose(-0.35F, between(-0.3, 0.3), 0, kPi + between(-0.3, 0.3)));
        add(workshop_.wallBoard(between(1.1, 1.4), between(0.7, 0.9)), T * pose(0, 0, 1.55F, 0));
    }
  }

  /// Small pictures and notices where a wall has neither furniture nor door.
  void fillGaps(Side side, const std::vector<float>& taken) {
    const Isometry3f T = wallFrame(side);
    const float end = wallLength(side) / 2 - 0.3F;
    for (float y = -end; y <= end; y += 0.55F) {
      const bool occupied = std::any_of(taken.begin(), taken.end(),
                                        [&](float middle) { return std::abs(middle - y) < kSlotM / 2 + 0.2F; });
      if (occupied || !clearOfDoors(side, y, 0.2F)) continue;
      const float height = between(0.35, 0.55), z = between(1.35, 1.6);
      add(workshop_.wallPicture(height * between(0.6, 0.75), height), T * pose(0, y, z, 0));
      if (rng_.below(2))
        add(workshop_.wallPicture(0.3F, 0.2F), T * pose(0, y + between(-0.1, 0.1), z - height / 2 - 0.2F, 0));
    }
  }

  void addWallDecor(const Isometry3f& T, float low_m) {
    if (rng_.below(4) == 0) {
      add(workshop_.window(1.2F, 2.3F - low_m), T * pose(0, 0, (low_m + 2.3F) / 2, 0));
      return;
    }
    const int count = 2 + static_cast<int>(rng_.below(2));
    for (int i = 0; i < count; ++i) {
      const float y = (static_cast<float>(i) + 0.5F) * kSlotM / static_cast<float>(count) - kSlotM / 2;
      const float height = between(0.45, 0.75), width = height * between(0.55, 0.75);
      add(workshop_.wallPicture(width, height),
          T * pose(0, y + between(-0.05, 0.05), low_m + height / 2 + between(0.02, 0.25), 0));
    }
  }

  void addCabinet(const Isometry3f& T) {
    const float height = between(0.7, 1.15);
    addSupport(workshop_.cabinet(between(0.8, 1.3), height), T * pose(-0.23F, 0, 0, 0));
    const Isometry3f top = T * pose(-0.23F, 0, height, 0);
    add(workshop_.plant(between(0.35, 0.55)), top * pose(0, between(0.2, 0.3), 0, 0));
    add(workshop_.bookPile(2 + static_cast<int>(rng_.below(4))), top * pose(0, between(-0.3, -0.2), 0, 0));
    add(rng_.below(2) ? workshop_.cup() : workshop_.bottle(), top * pose(-0.1F, between(-0.05, 0.1), 0, 0));
    addWallDecor(T, height + 0.55F);
  }

  void addDesk(const Isometry3f& T) {
    const float depth = between(0.7, 0.8), width = between(1.4, 1.7);
    const Isometry3f middle = T * pose(-depth / 2 - 0.02F, 0, 0, 0);
    addSupport(workshop_.desk(width, depth), middle);
    addDeskThings(middle * pose(0, 0, workshop_.deskHeight(), 0), depth, width);
    const float out = depth / 2 + between(0.12, 0.3);
    // The seated user looks at the wall (+x), and so does the chair; a little turned.
    add(rng_.below(3) ? workshop_.officeChair() : workshop_.woodenChair(),
        middle * pose(-out, between(-0.35, 0.35), 0, between(-0.6, 0.6)));
    addWallDecor(T, between(1.35, 1.5));
  }

  /// Monitors, keyboard, mouse and clutter; the frame is the middle of the table top.
  void addDeskThings(const Isometry3f& T, float depth, float width) {
    const bool laptop = rng_.below(3) == 0;
    const int monitors = laptop ? 1 : 1 + static_cast<int>(rng_.below(2));
    for (int i = 0; i < monitors; ++i) {
      const float y = laptop ? 0.35F : (static_cast<float>(i) - 0.5F * static_cast<float>(monitors - 1)) * 0.62F;
      add(workshop_.monitor(), T * pose(0.16F, y + between(-0.04, 0.04), 0, 0.3F * y + between(-0.12, 0.12)));
    }
    const float keyboard_x = -depth / 2 + between(0.13, 0.2);
    if (laptop) add(workshop_.laptop(), T * pose(-0.05F, -0.3F, 0, between(-0.3, 0.1)));
    add(workshop_.keyboard(), T * pose(keyboard_x, between(-0.05, 0.15), 0, between(-0.15, 0.15)));
    add(workshop_.mouse(), T * pose(keyboard_x, between(-0.4, -0.32), 0, between(-0.4, 0.4)));
    add(workshop_.cup(), T * pose(between(-0.1, 0.05), width / 2 - between(0.12, 0.3), 0, between(-2, 2)));
    add(workshop_.bottle(), T * pose(between(0.0, 0.2), -width / 2 + between(0.1, 0.2), 0, 0));
    add(workshop_.bookPile(1 + static_cast<int>(rng_.below(4))),
        T * pose(between(-0.15, 0.1), -width / 2 + between(0.25, 0.4), 0, between(-0.4, 0.4)));
    add(workshop_.papers(), T * pose(-depth / 2 + 0.22F, width / 2 - 0.28F, 0, 0));
    if (rng_.below(2)) add(workshop_.penHolder(), T * pose(0.2F, width / 2 - between(0.08, 0.14), 0, 0));
    if (rng_.below(3) == 0) add(workshop_.deskLamp(), T * pose(0.22F, width / 2 - 0.25F, 0, between(-1, 1)));
  }

  void addMeetingTable() {
    const Isometry3f T = pose(static_cast<float>(spec_.center_m.x() + shift_rng_.uniform(-1, 1) * spec_.shift_m),
                              static_cast<float>(spec_.center_m.y() + shift_rng_.uniform(-1, 1) * spec_.shift_m), 0, 0);
    const float radius = between(0.42, 0.52);
    add(workshop_.roundTable(radius), T);
    const Isometry3f top = T * pose(0, 0, workshop_.deskHeight(), 0);
    add(workshop_.laptop(), top * pose(0.1F, 0.15F, 0, between(0, 6)));
    add(workshop_.cup(), top * pose(-0.25F, 0.1F, 0, 0));
    add(workshop_.bottle(), top * pose(0.05F, -0.25F, 0, 0));
    add(workshop_.papers(), top * pose(-0.2F, -0.1F, 0, 1));
    for (int i = 0; i < 3; ++i) {
      const float angle = between(-0.3, 0.3) + 2.0F * kPi * static_cast<float>(i) / 3.0F;
      const Isometry3f seat = pose(T.translation().x(), T.translation().y(), 0, angle) * pose(-radius - 0.2F, 0, 0, 0);
      add(rng_.below(2) ? workshop_.woodenChair() : workshop_.officeChair(), seat);
    }
  }

  /// Posters from floor to ceiling: flat, and rich in corners.
  void paperWall(Side side) {
    const Isometry3f T = wallFrame(side);
    const float half = wallLength(side) / 2;
    for (float y = -half + 0.45F; y < half - 0.3F; y += 0.8F) {
      for (float z = 0.55F; z < spec_.size_m.z() - 0.3; z += 0.8F) {
        Primitives sheet = workshop_.wallPicture(between(0.5, 0.72), between(0.5, 0.72));
        sheet[0].scale.x() = 0.0005F;  // no thicker than paper: the wall stays one plane
        sheet[0].T_world_local.translation().x() = -0.0005F;
        add(sheet, T * pose(0, y + between(-0.04, 0.04), z + between(-0.04, 0.04), 0));
      }
    }
  }

  void addShadows() {
    // Only this room's things cast; others are behind walls.
    addShadowLayers(scene_, supports_, first_);
  }

  std::vector<PointLight> addLamps() {
    std::vector<PointLight> lamps;
    const int panel = workshop_.paint(plastic(cv::Scalar::all(250), rng_), 0.3F, 0.0F, 1.0F);
    const auto h = static_cast<float>(spec_.size_m.z());
    const double warm = rng_.uniform(0.88, 1.06), strength = rng_.uniform(0.42, 0.58);
    for (const float side : {-1.0F, 1.0F}) {
      PointLight lamp;
      lamp.position_m = {
          static_cast<float>(spec_.center_m.x() + side * 0.25 * spec_.size_m.x() + rng_.uniform(-0.3, 0.3)),
          static_cast<float>(spec_.center_m.y() + rng_.uniform(-0.8, 0.8)), h - 0.1F};
      lamp.color = cv::Vec3f(static_cast<float>(strength * warm), static_cast<float>(strength),
                             static_cast<float>(strength / warm));
      const Eigen::Vector2f center = spec_.center_m.cast<float>();
      const Eigen::Vector2f half =
          (spec_.size_m.head<2>() / 2).cast<float>().array() + static_cast<float>(kWallThicknessM);
      lamp.low_m = center - half;
      lamp.high_m = center + half;
      lamp.reach_m = 0.55F * static_cast<float>(spec_.size_m.x());
      lamps.push_back(lamp);
      add({makeBox({0, 0, 0}, {0.3F, 1.2F, 0.04F}, panel, kBackground)},
          pose(lamp.position_m.x(), lamp.position_m.y(), h - 0.02F, 0));
    }
    return lamps;
  }

  const RoomSpec& spec_;
  Scene& scene_;
  Rng rng_, shift_rng_;
  Workshop workshop_;
  std::vector<int> supports_;
  int first_ = 0;
};

}  // namespace

std::vector<PointLight> buildRoom(const RoomSpec& spec, Scene& scene) { return RoomBuilder(spec, scene).build(); }

}  // namespace semantic_vslam::synthetic
