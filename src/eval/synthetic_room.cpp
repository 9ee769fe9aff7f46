// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "eval/synthetic_room.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "eval/synthetic/ray_caster.h"
#include "eval/synthetic/workshop.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

using namespace synthetic;

constexpr double kStartS = 1000.0;
constexpr float kMovingM = 0.002F;

struct Prop {
  Primitives parts;  // in its own frame
  PropSpec spec;
};

Primitives makeProp(const PropSpec& spec, Scene& scene) {
  Rng rng(spec.look_seed);
  Workshop workshop(scene, rng);
  switch (spec.kind) {
    case PropSpec::Kind::kOfficeChair: return workshop.officeChair();
    case PropSpec::Kind::kWoodenChair: return workshop.woodenChair();
    case PropSpec::Kind::kCarton: {
      const auto size = [&](double low, double high) { return static_cast<float>(rng.uniform(low, high)); };
      return workshop.carton({size(0.24, 0.34), size(0.34, 0.46), size(0.22, 0.34)});
    }
  }
  return {};
}

/// Marks solids of which any corner moved since the frame before.
void markMoving(Primitives& now, const Primitives& before) {
  for (std::size_t i = 0; i < now.size() && i < before.size(); ++i) {
    const auto corners = now[i].localCorners(), corners_before = before[i].localCorners();
    for (std::size_t c = 0; c < corners.size(); ++c) {
      const float way_m = (now[i].toWorld(corners[c]) - before[i].toWorld(corners_before[c])).norm();
      now[i].moving = now[i].moving || way_m > kMovingM;
    }
  }
}

}  // namespace

class SyntheticRoom::Impl {
 public:
  Impl(const Scenario& scenario, const CameraIntrinsics& intrinsics)
      : scenario_(scenario), caster_(std::make_shared<const CameraModel>(intrinsics)) {
    if (scenario_.rooms.empty()) throw ConfigError("synthetic scenario '" + scenario_.name + "' has no room");
    if (scenario_.camera.knots.empty())
      throw ConfigError("synthetic scenario '" + scenario_.name + "' has no camera path");
    for (const auto& room : scenario_.rooms) {
      for (const PointLight& lamp : buildRoom(room, scene_)) lighting_.lamps.push_back(lamp);
    }
    for (PointLight& lamp : lighting_.lamps) lamp.color *= static_cast<float>(scenario_.brightness);
    lighting_.ambient *= static_cast<float>(scenario_.brightness);
    for (const auto& person : scenario_.people) {
      bodies_.emplace_back(scene_, person.look_seed);
      motions_.emplace_back(person, scenario_.duration_s);
    }
    for (const auto& spec : scenario_.props) props_.push_back({scene_.numbered(makeProp(spec, scene_)), spec});
  }

  const Scenario& scenario() const { return scenario_; }

  Primitives standingAtTheEnd() const {
    Primitives all = scene_.primitives;
    for (const Prop& prop : props_) {
      const bool carried =
          prop.spec.carrier >= 0 && scenario_.people[prop.spec.carrier].release_s > scenario_.duration_s;
      if (!carried) append(all, placed(prop.parts, propPose(prop.spec, scenario_.duration_s)));
    }
    return all;
  }

  SyntheticFrame render(double time_s) const {
    std::vector<FloorShadow> shadows, unused;
    Primitives moving = moversAt(time_s, shadows);
    markMoving(moving, moversAt(std::max(0.0, time_s - 1.0 / scenario_.fps), unused));
    SyntheticFrame out;
    out.T_world_camera = scenario_.camera.at(time_s);
    const Rendering rendering = caster_.render(scene_, moving, shadows, lighting_, out.T_world_camera);
    out.true_depth_m = rendering.depth_m;
    fillMasks(rendering, moving, out);
    sense(rendering, time_s, out);
    return out;
  }

 private:
  Carrying carryingAt(const PersonSpec& person, double time_s) const {
    return time_s < person.release_s ? person.carrying : Carrying::kNothing;
  }

  /// Everything that can move, at a time, with its shadows on the floor.
  Primitives moversAt(double time_s, std::vector<FloorShadow>& shadows) const {
    Primitives all;
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      const PersonState state = motions_[i].at(time_s);
      append(all, bodies_[i].pose(state, carryingAt(scenario_.people[i], time_s), time_s));
      shadows.push_back({state.position_m.cast<float>(), 0.28F, 0.45F});
      shadows.push_back({state.position_m.cast<float>(), 0.60F, 0.2F});
    }
    for (const Prop& prop : props_) {
      const auto T = propPose(prop.spec, time_s);
      append(all, placed(prop.parts, T));
      shadows.push_back({T.translation().head<2>(), 0.30F, T.translation().z() > 0.1F ? 0.15F : 0.45F});
    }
    return all;
  }

  Eigen::Isometry3f propPose(const PropSpec& spec, double time_s) const {
    const Eigen::Vector3f at = spec.position_m.cast<float>();
    const auto local = synthetic::pose(at.x(), at.y(), at.z(), static_cast<float>(spec.yaw_rad));
    if (spec.carrier < 0) return local;
    const double held_until_s = scenario_.people[spec.carrier].release_s;
    const PersonState state = motions_[spec.carrier].at(std::min(time_s, held_until_s));
    return synthetic::pose(static_cast<float>(state.position_m.x()), static_cast<float>(state.position_m.y()), 0,
                           static_cast<float>(state.heading_rad)) *
           local;
  }

  void fillMasks(const Rendering& rendering, const Primitives& moving, SyntheticFrame& out) const {
    const cv::Size size = rendering.depth_m.size();
    out.person_mask = cv::Mat1b(size, 0);
    out.moving_mask = cv::Mat1b(size, 0);
    out.labels = cv::Mat1b(size, kBackground);
    const auto still = static_cast<int>(scene_.primitives.size());
    for (int v = 0; v < size.height; ++v) {
      for (int u = 0; u < size.width; ++u) {
        const int index = rendering.primitive(v, u);
        if (index < 0) continue;
        const Primitive& solid = index < still ? scene_.primitives[index] : moving[index - still];
        out.labels(v, u) = solid.label;
        out.person_mask(v, u) = solid.label == kPerson ? 255 : 0;
        out.moving_mask(v, u) = solid.moving ? 255 : 0;
      }
    }
  }

  void sense(const Rendering& rendering, double time_s, SyntheticFrame& out) const {
    const auto index = static_cast<std::uint64_t>(std::llround(time_s * scenario_.fps));
    const std::uint64_t noise_seed =
        scenario_.seed * 1000003ULL + static_cast<std::uint64_t>(std::llround(time_s * 1e6)) * 2ULL;
    const cv::Mat3b bgr = senseColor(rendering.bgr, scenario_.sensor, noise_seed);
    const cv::Mat1f depth_m = senseDepth(rendering.depth_m, caster_.camera()->fx(), scenario_.sensor, noise_seed + 1);
    out.frame = makeRgbdFrame(index, stampAt(time_s), bgr, depth_m, 1.0, caster_.camera());
  }

  Scenario scenario_;
  RayCaster caster_;
  Scene scene_;
  Lighting lighting_;
  std::vector<PersonBody> bodies_;
  std::vector<PersonMotion> motions_;
  std::vector<Prop> props_;
};

LabelSet syntheticLabels() {
  LabelSet set;
  set.classes = {{"background", Mobility::kStatic, {90, 90, 90}},  {"person", Mobility::kPerson, {60, 60, 230}},
                 {"chair", Mobility::kMovable, {60, 180, 240}},    {"monitor", Mobility::kStatic, {220, 120, 40}},
                 {"keyboard", Mobility::kMovable, {180, 60, 180}}, {"mouse", Mobility::kMovable, {120, 240, 240}},
                 {"book", Mobility::kMovable, {60, 200, 60}},      {"laptop", Mobility::kMovable, {200, 200, 60}},
                 {"bottle", Mobility::kMovable, {140, 80, 250}},   {"cup", Mobility::kMovable, {90, 240, 150}},
                 {"table", Mobility::kStatic, {60, 110, 160}}};
  return set;
}

SyntheticRoom::SyntheticRoom(const Scenario& scenario, const CameraIntrinsics& intrinsics)
    : impl_(std::make_unique<const Impl>(scenario, intrinsics)) {}
SyntheticRoom::~SyntheticRoom() = default;

SyntheticFrame SyntheticRoom::render(double time_s) const { return impl_->render(time_s); }
Stamp SyntheticRoom::stampAt(double time_s) { return Stamp::fromSeconds(kStartS + time_s); }
Primitives SyntheticRoom::standingAtTheEnd() const { return impl_->standingAtTheEnd(); }
const Scenario& SyntheticRoom::scenario() const { return impl_->scenario(); }
int SyntheticRoom::frameCount() const {
  return std::max(1, static_cast<int>(std::lround(impl_->scenario().duration_s * impl_->scenario().fps)));
}

}  // namespace semantic_vslam
