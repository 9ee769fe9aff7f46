// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "eval/synthetic/depth_sensor.h"
#include "eval/synthetic/room_builder.h"
#include "eval/synthetic/walker.h"
#include "semantic_vslam/core/geometry/se3.h"

namespace semantic_vslam {

/// Control point of the camera's path. The camera looks along yaw (about world z, from +x to +y) and pitch (up > 0).
struct CameraKnot {
  Eigen::Vector3d position_m = {0, 0, 1.25};
  double yaw_rad = 0.0, pitch_rad = 0.0;
};

/// Uniform cubic B-spline through space, with the tremor of a hand on top: twice differentiable and exact at any time.
struct CameraPath {
  std::vector<CameraKnot> knots;  ///< at least 1; the first and the last are held
  double knot_interval_s = 1.0;
  double tremor_m = 0.004, tremor_rad = 0.004;  ///< amplitude of each of three sines, 0.6 to 4 Hz, per axis
  std::uint64_t tremor_seed = 1;

  /// @return pose of the optical frame (x right, y down, z forward) at a time in seconds from the start.
  SE3 at(double time_s) const;
};

/// A thing that is not part of a room's furniture: a chair to sit on, a chair that is pushed, a box that is carried.
struct PropSpec {
  enum class Kind { kOfficeChair, kWoodenChair, kCarton };
  Kind kind = Kind::kOfficeChair;
  Eigen::Vector3d position_m = {0, 0, 0};  ///< in the world, or in front of its carrier (x forward, y left)
  double yaw_rad = 0.0;
  int carrier = -1;  ///< index of the person that moves it until its release_s; -1 = stands still
  std::uint64_t look_seed = 1;
};

/// All that a synthetic recording is made from.
struct Scenario {
  std::string name;
  std::uint64_t seed = 1;
  double duration_s = 20.0;
  double fps = 30.0;
  std::vector<synthetic::RoomSpec> rooms;
  std::vector<synthetic::PersonSpec> people;
  std::vector<PropSpec> props;
  CameraPath camera;
  double brightness = 1.0;
  synthetic::SensorModel sensor;
};

/// @return name and one-line description of every scenario.
std::vector<std::pair<std::string, std::string>> listScenarios();

/// Another seed gives other textures, furniture, people and a somewhat other path.
/// @param duration_s  0 = as long as the scenario naturally is
/// @throws ConfigError if there is no such scenario (the message lists them) or duration_s is negative or not finite.
Scenario makeScenario(const std::string& name, std::uint64_t seed, double duration_s = 0.0);

/// When to render a random view: its people have walked a few steps by then and are in any phase of a stride.
constexpr double kRandomViewTimeS = 5.0;
/// One random room, camera, light and handful of people in random poses, for training data.
Scenario makeRandomView(std::uint64_t seed);

}  // namespace semantic_vslam
