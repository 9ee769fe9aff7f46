// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "eval/scenario.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/common/rng.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using synthetic::Carrying;
using synthetic::Furnishing;
using synthetic::kWallThicknessM;
using synthetic::PersonAction;
using synthetic::PersonSpec;
using synthetic::RoomSpec;
using synthetic::Side;

CameraKnot lookAt(const Vector3d& position_m, const Vector3d& target_m) {
  const Vector3d way = target_m - position_m;
  return {position_m, std::atan2(way.y(), way.x()), std::atan2(way.z(), way.head<2>().norm())};
}

/// Draws for one scenario.
class Director {
 public:
  Director(const std::string& name, std::uint64_t seed, double duration_s, double natural_duration_s)
      : rng_(seed * 7919 + 17) {
    scenario_.name = name;
    scenario_.seed = seed;
    scenario_.duration_s = duration_s > 0.0 ? duration_s : natural_duration_s;
    scenario_.brightness = rng_.uniform(0.85, 1.12);
    scenario_.camera.tremor_seed = rng_.below(1U << 30);
  }

  Scenario& scenario() { return scenario_; }
  double between(double low, double high) { return rng_.uniform(low, high); }
  std::uint64_t seed() { return rng_.below(1U << 30); }
  bool chance(double probability) { return rng_.uniform() < probability; }

  RoomSpec& addRoom(Furnishing furnishing) {
    RoomSpec room;
    room.size_m = {between(5.8, 6.3), between(5.3, 5.8), between(2.5, 2.8)};
    room.furnishing = furnishing;
    room.look_seed = seed();
    scenario_.rooms.push_back(room);
    return scenario_.rooms.back();
  }

  PersonSpec& addPerson(const Vector2d& start_m, double heading_rad) {
    PersonSpec person;
    person.start_m = start_m;
    person.heading_rad = heading_rad;
    person.speed_mps = between(0.85, 1.25);
    person.look_seed = seed();
    scenario_.people.push_back(person);
    return scenario_.people.back();
  }

  void addProp(PropSpec::Kind kind, const Vector3d& position_m, double yaw_rad, int carrier) {
    scenario_.props.push_back({kind, position_m, yaw_rad, carrier, seed()});
  }

  /// A hand-held camera that sways around a place and keeps looking at an area.
  void holdCamera(const Vector3d& place_m, const Vector3d& sway_m, const Vector3d& target_m,
                  const Vector3d& target_sway_m) {
    auto& camera = scenario_.camera;
    camera.knot_interval_s = 1.1;
    const int count = static_cast<int>(scenario_.duration_s / camera.knot_interval_s) + 4;
    for (int i = 0; i < count; ++i)
      camera.knots.push_back(lookAt(around(place_m, sway_m), around(target_m, target_sway_m)));
  }

  /// Walks to and fro between two areas, with a wait now and then, until the end.
  void pace(PersonSpec& person, const Vector2d& a, const Vector2d& b, double wait_probability) {
    double time_s = 0.0;
    bool to_b = true;
    while (time_s < scenario_.duration_s) {
      const Vector2d end = (to_b ? b : a) + Vector2d(between(-0.12, 0.12), between(-0.1, 0.1));
      if (chance(wait_probability)) {
        const Vector2d middle = 0.5 * (a + b) + Vector2d(between(-0.1, 0.1), between(-0.4, 0.4));
        person.script.push_back(PersonAction::walkTo(middle.x(), middle.y()));
        person.script.push_back(PersonAction::turnTo(between(2.2, 4.1)));
        person.script.push_back(PersonAction::wait(between(1.0, 2.5)));
        time_s += 3.0;
      }
      person.script.push_back(PersonAction::walkTo(end.x(), end.y()));
      person.script.push_back(PersonAction::wait(between(0.2, 1.0)));
      time_s += (b - a).norm() / person.speed_mps + 1.5;
      to_b = !to_b;
    }
  }

 private:
  Vector3d around(const Vector3d& middle, const Vector3d& half) {
    return middle + half.cwiseProduct(Vector3d(between(-1, 1), between(-1, 1), between(-1, 1)));
  }

  Scenario scenario_;
  Rng rng_;
};

/// Camera in the middle of the office, looking at the desks along +x.
void lookAtDesks(Director& director) {
  director.addRoom(Furnishing::kOffice);
  director.holdCamera({-0.45, 0.0, 1.3}, {0.3, 0.65, 0.2}, {2.5, 0.0, 1.0}, {0.1, 0.5, 0.15});
}

Scenario makeWalking(Director& director) {
  lookAtDesks(director);
  const double near_x = director.between(0.75, 0.95), far_x = director.between(1.15, 1.35);
  auto& first = director.addPerson({near_x, -1.75}, M_PI / 2);
  first.script.push_back(PersonAction::wait(director.between(1.0, 2.0)));
  director.pace(first, {near_x, -1.75}, {near_x, 1.75}, 0.25);
  // In view and on the move from the first frame on: the first map must do without people, too.
  auto& second = director.addPerson({far_x, director.between(0.6, 0.9)}, -M_PI / 2);
  director.pace(second, {far_x, 1.75}, {far_x, -1.75}, 0.35);
  return director.scenario();
}

Scenario makeSitting(Director& director) {
  lookAtDesks(director);
  const double x = director.between(1.0, 1.2);
  for (const double side : {-1.0, 1.0}) {
    const Vector2d place(x + director.between(-0.1, 0.1), side * director.between(0.55, 0.7));
    const double heading = -side * M_PI / 2 + side * director.between(-0.6, -0.2);
    auto& person = director.addPerson(place, heading);
    person.seated = true;
    const Vector2d seat = place - 0.02 * Vector2d(std::cos(heading), std::sin(heading));
    director.addProp(director.chance(0.5) ? PropSpec::Kind::kOfficeChair : PropSpec::Kind::kWoodenChair,
                     {seat.x(), seat.y(), 0.0}, heading, -1);
    if (side > 0)
      person.script = {PersonAction::wait(7.0), PersonAction::standUp(), PersonAction::wait(2.0), PersonAction::sit()};
  }
  return director.scenario();
}

Scenario makeStatic(Director& director) {
  lookAtDesks(director);
  return director.scenario();
}

Scenario makeRotation(Director& director) {
  director.addRoom(Furnishing::kOffice);
  auto& scenario = director.scenario();
  scenario.camera.knot_interval_s = 1.5;
  scenario.camera.tremor_m = 0.0;
  const Vector3d place(-0.6, 0.0, 1.35);
  const int count = static_cast<int>(scenario.duration_s / scenario.camera.knot_interval_s) + 4;
  for (int i = 0; i < count; ++i) {
    scenario.camera.knots.push_back(
        {place, ((i / 2) % 2 ? 0.75 : -0.75) + director.between(-0.1, 0.1), director.between(-0.3, -0.05)});
  }
  director.pace(director.addPerson({0.6, -1.7}, M_PI / 2), {0.6, -1.7}, {0.8, 1.7}, 0.2);
  director.pace(director.addPerson({1.1, 1.7}, -M_PI / 2), {1.1, 1.7}, {1.2, -1.7}, 0.2);
  return scenario;
}

Scenario makePlanarWall(Director& director) {
  const double wall_x = director.addRoom(Furnishing::kWallOnly).size_m.x() / 2;
  director.holdCamera({wall_x - 1.95, 0.0, 1.3}, {0.1, 0.4, 0.08}, {wall_x, 0.0, 1.3}, {0.0, 0.3, 0.05});
  director.pace(director.addPerson({wall_x - 0.6, -2.0}, M_PI / 2), {wall_x - 0.6, -2.0}, {wall_x - 0.55, 2.0}, 0.1);
  return director.scenario();
}

Scenario makeNearMover(Director& director) {
  director.addRoom(Furnishing::kOffice);
  director.holdCamera({-0.5, 0.0, 1.12}, {0.05, 0.15, 0.05}, {2.5, 0.0, 1.1}, {0.1, 0.3, 0.1});
  // In, then close to the camera for most of the time, swaying and turning.
  auto& person = director.addPerson({0.02, -1.6}, M_PI / 2);
  person.speed_mps = 0.7;
  person.script = {PersonAction::wait(2.0)};
  for (double time_s = 0.0; time_s < director.scenario().duration_s; time_s += 3.0) {
    person.script.push_back(PersonAction::walkTo(-0.01 + director.between(-0.03, 0.05), director.between(-0.12, 0.12)));
    person.script.push_back(
        PersonAction::turnTo(director.chance(0.5) ? director.between(-0.5, 0.5) : M_PI + director.between(-0.5, 0.5)));
    person.script.push_back(PersonAction::wait(director.between(0.2, 0.8)));
    person.script.push_back(PersonAction::walkTo(0.02, director.between(-0.3, 0.3)));
  }
  return director.scenario();
}

Scenario makePushedChair(Director& director) {
  lookAtDesks(director);
  const double x = director.between(0.85, 1.15);
  auto& person = director.addPerson({x, -1.8}, M_PI / 2);
  person.speed_mps = director.between(0.55, 0.75);
  person.carrying = Carrying::kPushing;
  person.release_s = 2.0 + 2.4 / person.speed_mps;
  person.script = {PersonAction::wait(1.5), PersonAction::walkTo(x, 0.55), PersonAction::wait(1.0),
                   PersonAction::walkTo(x - 0.2, -0.2), PersonAction::walkTo(x - 0.2, -1.8)};
  person.release_s = 2.5 + 2.35 / person.speed_mps;
  director.addProp(PropSpec::Kind::kOfficeChair, {0.62, 0.0, 0.0}, 0.0, 0);
  return director.scenario();
}

Scenario makeCarriedBox(Director& director) {
  lookAtDesks(director);
  const double x = director.between(0.8, 1.1);
  auto& person = director.addPerson({x, -1.75}, M_PI / 2);
  person.carrying = Carrying::kBox;
  director.pace(person, {x, -1.75}, {x, 1.75}, 0.4);
  director.addProp(PropSpec::Kind::kCarton, {0.42, 0.0, 0.86}, 0.0, 0);
  return director.scenario();
}

Scenario makeAlongAxis(Director& director) {
  director.addRoom(Furnishing::kOffice);
  director.holdCamera({-1.45, 0.0, 1.3}, {0.1, 0.2, 0.1}, {2.5, 0.0, 1.05}, {0.1, 0.2, 0.1});
  auto& person = director.addPerson({1.3, director.between(-0.15, 0.15)}, M_PI);
  person.speed_mps = director.between(0.7, 1.0);
  for (double time_s = 0.0; time_s < director.scenario().duration_s; time_s += 6.0) {
    person.script.push_back(PersonAction::walkTo(-0.35, director.between(-0.25, 0.25)));
    person.script.push_back(PersonAction::wait(0.3));
    person.script.push_back(PersonAction::walkTo(1.3, director.between(-0.25, 0.25)));
    person.script.push_back(PersonAction::wait(0.3));
  }
  return director.scenario();
}

Scenario makePause(Director& director) {
  lookAtDesks(director);
  const double x = director.between(0.85, 1.2);
  auto& person = director.addPerson({x, -1.75}, M_PI / 2);
  for (double time_s = 0.0; time_s < director.scenario().duration_s; time_s += 14.0) {
    for (const double side : {1.0, -1.0}) {
      person.script.push_back(PersonAction::walkTo(x, director.between(-0.3, 0.3)));
      person.script.push_back(PersonAction::turnTo(director.between(2.4, 3.9)));
      person.script.push_back(PersonAction::wait(3.0));
      person.script.push_back(PersonAction::walkTo(x, side * 1.75));
      person.script.push_back(PersonAction::wait(0.5));
    }
  }
  return director.scenario();
}

/// Camera that walks along straight legs with rounded corners and looks ahead, a little to one side.
void walkCamera(Director& director, const std::vector<Vector2d>& corners, double look_aside_rad) {
  auto& scenario = director.scenario();
  constexpr double kKnotM = 0.45;
  double length_m = 0.0;
  for (std::size_t i = 1; i < corners.size(); ++i) length_m += (corners[i] - corners[i - 1]).norm();
  const auto pointAt = [&](double way_m) {
    std::size_t i = 1;
    while (i + 1 < corners.size() && way_m > (corners[i] - corners[i - 1]).norm()) {
      way_m -= (corners[i] - corners[i - 1]).norm();
      ++i;
    }
    return Vector2d(corners[i - 1] + (corners[i] - corners[i - 1]).normalized() * way_m);
  };
  const int count = static_cast<int>(length_m / kKnotM);
  double yaw = 0.0;
  for (int i = 0; i <= count; ++i) {
    // A chord of 2.2 m rounds the corners; it also is where the camera looks.
    const double way_m = i * kKnotM;
    const Vector2d behind = pointAt(std::max(way_m - 1.1, 0.0)), ahead = pointAt(std::min(way_m + 1.1, length_m));
    const Vector2d place = (behind + pointAt(way_m) + ahead) / 3.0;
    const double heading = std::atan2(ahead.y() - behind.y(), ahead.x() - behind.x()) + look_aside_rad;
    yaw = i == 0 ? heading : yaw + std::remainder(heading - yaw, 2.0 * M_PI);
    scenario.camera.knots.push_back({{place.x() + director.between(-0.06, 0.06),
                                      place.y() + director.between(-0.06, 0.06), 1.3 + director.between(-0.06, 0.06)},
                                     yaw + director.between(-0.12, 0.12),
                                     director.between(-0.16, -0.04)});
  }
  scenario.camera.knot_interval_s = scenario.duration_s / static_cast<double>(scenario.camera.knots.size());
}

Scenario makeLoop(Director& director) {
  constexpr double kRoomM = 7.0, kCenterM = kRoomM / 2 + kWallThicknessM, kTrackM = 4.9;
  for (const auto& [sx, sy] : {std::pair(-1, -1), {1, -1}, {1, 1}, {-1, 1}}) {
    auto& room = director.addRoom(Furnishing::kMeeting);
    room.size_m = {kRoomM, kRoomM, 2.6};
    room.center_m = {sx * kCenterM, sy * kCenterM};
    const double offset_m = kTrackM - kCenterM;
    room.doorways = {{sx < 0 ? Side::kPlusX : Side::kMinusX, sy * offset_m},
                     {sy < 0 ? Side::kPlusY : Side::kMinusY, sx * offset_m}};
  }
  const double start_x = director.between(-3.2, -2.2);
  walkCamera(director,
             {{start_x, -kTrackM},
              {kTrackM, -kTrackM},
              {kTrackM, kTrackM},
              {-kTrackM, kTrackM},
              {-kTrackM, -kTrackM},
              {start_x + 3.0, -kTrackM}},
             director.between(-0.45, -0.25));
  return director.scenario();
}

Scenario makeCorridorOf(Director& director, double shift_m) {
  constexpr int kRooms = 6;
  constexpr double kPitchM = 5.0 + 2 * kWallThicknessM, kDoorM = -1.25;
  const std::uint64_t look = director.seed();
  for (int i = 0; i < kRooms; ++i) {
    auto& room = director.addRoom(Furnishing::kOffice);
    room.size_m = {5.0, 5.4, 2.6};
    room.center_m = {i * kPitchM, 0.0};
    room.look_seed = look;
    room.shift_seed = director.seed();
    room.shift_m = shift_m;
    if (i > 0) room.doorways.push_back({Side::kMinusX, kDoorM});
    if (i + 1 < kRooms) room.doorways.push_back({Side::kPlusX, kDoorM});
  }
  walkCamera(director, {{-1.2, kDoorM}, {(kRooms - 1) * kPitchM + 0.4, kDoorM}}, director.between(0.25, 0.45));
  return director.scenario();
}

Scenario makeCorridor(Director& director) { return makeCorridorOf(director, 0.18); }
Scenario makeIdenticalCorridor(Director& director) { return makeCorridorOf(director, 0.0); }

struct Entry {
  const char* name;
  const char* description;
  double natural_duration_s;
  Scenario (*make)(Director&);
};

constexpr Entry kEntries[] = {
    {"walking", "hand-held camera at the desks of an office, two people walk through (the demo)", 20, makeWalking},
    {"sitting", "the same with two people who sit, talk and once stand up", 20, makeSitting},
    {"static", "the same room with nobody in it", 20, makeStatic},
    {"rotation", "the camera only rotates, two people walk", 20, makeRotation},
    {"planar_wall", "one papered wall fills the view, one person walks along it", 15, makePlanarWall},
    {"near_mover", "a person close to the camera covers most of the image", 15, makeNearMover},
    {"pushed_chair", "a person pushes a chair in, leaves it and walks away", 15, makePushedChair},
    {"carried_box", "a person carries a box to and fro", 15, makeCarriedBox},
    {"along_axis", "a person walks towards the camera and away again", 15, makeAlongAxis},
    {"pause", "a person walks, stops for 3 s and walks on", 20, makePause},
    {"loop", "42 m through four rooms and 3 m past the start", 60, makeLoop},
    {"corridor", "27 m through six rooms of the same things, a little moved; no place is seen twice", 40, makeCorridor},
    {"corridor_identical", "the same with rooms that do not differ at all", 40, makeIdenticalCorridor},
};

/// Basis of the uniform cubic B-spline at u in 0..1.
Eigen::Vector4d splineWeights(double u) {
  const double v = 1.0 - u;
  return Eigen::Vector4d(v * v * v, 3 * u * u * u - 6 * u * u + 4, 3 * v * v * v - 6 * v * v + 4, u * u * u) / 6.0;
}

double tremor(Rng& rng, double time_s) {
  double sum = 0.0;
  for (const double base_hz : {0.6, 1.5, 3.2}) {
    const double hz = base_hz * rng.uniform(0.8, 1.25), phase = rng.uniform(0, 2 * M_PI);
    sum += std::sin(2.0 * M_PI * hz * time_s + phase) / (base_hz / 0.6);
  }
  return sum;
}

}  // namespace

SE3 CameraPath::at(double time_s) const {
  assert(!knots.empty());
  const double position = std::max(time_s, 0.0) / knot_interval_s;
  const int segment = static_cast<int>(position);
  const Eigen::Vector4d weights = splineWeights(position - segment);
  CameraKnot blended{{0, 0, 0}, 0, 0};
  for (int i = 0; i < 4; ++i) {
    const CameraKnot& knot = knots[std::clamp(segment + i - 1, 0, static_cast<int>(knots.size()) - 1)];
    blended.position_m += weights[i] * knot.position_m;
    blended.yaw_rad += weights[i] * knot.yaw_rad;
    blended.pitch_rad += weights[i] * knot.pitch_rad;
  }
  Rng rng(tremor_seed);
  for (int axis = 0; axis < 3; ++axis) blended.position_m[axis] += tremor_m * tremor(rng, time_s);
  const double yaw = blended.yaw_rad + tremor_rad * tremor(rng, time_s);
  const double pitch = blended.pitch_rad + tremor_rad * tremor(rng, time_s);
  const double roll = 1.5 * tremor_rad * tremor(rng, time_s);
  const Vector3d forward(std::cos(yaw) * std::cos(pitch), std::sin(yaw) * std::cos(pitch), std::sin(pitch));
  const Vector3d right(std::sin(yaw), -std::cos(yaw), 0.0);
  SE3 T_world_camera = SE3::Identity();
  T_world_camera.linear() << right, forward.cross(right), forward;
  T_world_camera.linear() = T_world_camera.linear() * Eigen::AngleAxisd(roll, Vector3d::UnitZ()).toRotationMatrix();
  T_world_camera.translation() = blended.position_m;
  return T_world_camera;
}

std::vector<std::pair<std::string, std::string>> listScenarios() {
  std::vector<std::pair<std::string, std::string>> names;
  for (const Entry& entry : kEntries) names.emplace_back(entry.name, entry.description);
  return names;
}

Scenario makeScenario(const std::string& name, std::uint64_t seed, double duration_s) {
  if (!(duration_s >= 0.0) || !std::isfinite(duration_s)) {
    throw ConfigError("scenario duration must be 0 (natural) or more seconds, is " + std::to_string(duration_s));
  }
  std::string known;
  for (const Entry& entry : kEntries) {
    if (name == entry.name) {
      Director director(name, seed, duration_s, entry.natural_duration_s);
      return entry.make(director);
    }
    known += std::string(known.empty() ? "" : ", ") + entry.name;
  }
  throw ConfigError("no scenario '" + name + "'; there are: " + known);
}

Scenario makeRandomView(std::uint64_t seed) {
  Director director("random_view", seed, 0.0, 12.0);
  auto& scenario = director.scenario();
  auto& room = director.addRoom(director.chance(0.3) ? Furnishing::kMeeting : Furnishing::kOffice);
  room.size_m = {director.between(4.8, 7.5), director.between(4.6, 6.5), director.between(2.4, 3.0)};
  scenario.brightness = director.between(0.65, 1.25);
  const Vector2d free = room.size_m.head<2>() / 2 - Vector2d(1.4, 1.4);
  const Vector3d eye(director.between(-1, 1) * free.x(), director.between(-1, 1) * free.y(),
                     director.between(0.5, 1.8));
  // Half of the views are on the desks, the others anywhere.
  const double yaw = director.chance(0.5) ? director.between(-0.7, 0.7) : director.between(-M_PI, M_PI);
  scenario.camera.knots = {{eye, yaw, director.between(-0.45, 0.1)}};
  scenario.camera.tremor_rad = 0.03;
  scenario.sensor.color_noise = director.between(0.5, 4.0);
  scenario.sensor.blur_px = director.between(0.4, 1.0);
  const int people = static_cast<int>(director.between(0.0, 4.99));
  for (int i = 0; i < people; ++i) {
    const double distance_m = director.between(0.8, 3.5), bearing = yaw + director.between(-0.6, 0.6);
    const Vector2d place = (eye.head<2>() + distance_m * Vector2d(std::cos(bearing), std::sin(bearing)))
                               .cwiseMax(-free - Vector2d(0.4, 0.4))
                               .cwiseMin(free + Vector2d(0.4, 0.4));
    if ((place - eye.head<2>()).norm() < 0.6) continue;
    const double heading = director.between(-M_PI, M_PI);
    auto& person = director.addPerson(place, heading);
    person.seated = director.chance(0.3);
    if (person.seated) {
      director.addProp(director.chance(0.5) ? PropSpec::Kind::kOfficeChair : PropSpec::Kind::kWoodenChair,
                       {place.x(), place.y(), 0.0}, heading, -1);
      continue;
    }
    if (director.chance(0.15)) {
      person.carrying = Carrying::kBox;
      director.addProp(PropSpec::Kind::kCarton, {0.42, 0.0, 0.86}, 0.0, static_cast<int>(scenario.people.size()) - 1);
    }
    // Walks for a moment before the picture is taken, so that every phase of a stride is seen.
    if (director.chance(0.4)) continue;  // stands
    const double approach_m = person.speed_mps * (kRandomViewTimeS - director.between(0.4, 0.7));
    person.start_m -= Vector2d(std::cos(heading), std::sin(heading)) * approach_m;
    const Vector2d beyond = place + 4.0 * Vector2d(std::cos(heading), std::sin(heading));
    person.script = {PersonAction::walkTo(beyond.x(), beyond.y())};
  }
  return scenario;
}

}  // namespace semantic_vslam
