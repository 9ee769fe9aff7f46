// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "eval/synthetic/scene.h"

namespace semantic_vslam::synthetic {

/// One thing a person does; a script is a list of them, done in order, the last one held.
struct PersonAction {
  enum class Kind { kWalkTo, kWait, kTurnTo, kSit, kStandUp };
  Kind kind = Kind::kWait;
  Eigen::Vector2d target_m = {0, 0};  ///< kWalkTo
  double heading_rad = 0.0;           ///< kTurnTo
  double seconds = 0.0;               ///< kWait

  static PersonAction walkTo(double x_m, double y_m) { return {Kind::kWalkTo, {x_m, y_m}, 0.0, 0.0}; }
  static PersonAction wait(double seconds) { return {Kind::kWait, {0, 0}, 0.0, seconds}; }
  static PersonAction turnTo(double heading_rad) { return {Kind::kTurnTo, {0, 0}, heading_rad, 0.0}; }
  static PersonAction sit() { return {Kind::kSit, {0, 0}, 0.0, 0.0}; }
  static PersonAction standUp() { return {Kind::kStandUp, {0, 0}, 0.0, 0.0}; }
};

/// What the hands do.
enum class Carrying { kNothing, kBox, kPushing };

struct PersonSpec {
  Eigen::Vector2d start_m = {0, 0};
  double heading_rad = 0.0;
  bool seated = false;  ///< at the start
  double speed_mps = 1.1;
  std::vector<PersonAction> script;
  Carrying carrying = Carrying::kNothing;
  double release_s = 1e9;       ///< from then on the hands are free, and what they pushed stays
  std::uint64_t look_seed = 1;  ///< body, clothes, hair
};

/// Where a person is and how it holds itself at one time.
struct PersonState {
  Eigen::Vector2d position_m = {0, 0};
  double heading_rad = 0.0;
  double stride_rad = 0.0;  ///< phase of the walk; 2 pi = two steps
  double stride = 0.0;      ///< 0 standing .. 1 full strides
  double seated = 0.0;      ///< 0 standing .. 1 seated
};

/// A script played at 100 Hz with limited acceleration and turn rate, so that motion is smooth; looked up by time.
class PersonMotion {
 public:
  PersonMotion(const PersonSpec& spec, double duration_s);
  /// @param time_s  clamped to 0..duration
  PersonState at(double time_s) const;

 private:
  std::vector<PersonState> states_;
};

/// A dressed body of rounded cones and ellipsoids. Frame: origin on the floor between the feet, x forward, z up.
class PersonBody {
 public:
  /// Draws shape and clothes from the seed and adds their looks to the scene.
  PersonBody(Scene& scene, std::uint64_t look_seed);

  /// @param time_s  for small idle motion  @return solids in the world, all labelled as a person
  Primitives pose(const PersonState& state, Carrying carrying, double time_s) const;
  double height() const { return height_m_; }

 private:
  struct Look {
    int skin, head, hair, shirt, trousers, shoes, sleeves, belt;
  };
  struct Legs {
    Eigen::Vector3f hip, knee, ankle;
    float foot_pitch_rad;
  };
  Legs poseLeg(float side, const PersonState& state) const;
  void addLeg(Primitives& parts, const Legs& leg) const;
  void addArm(Primitives& parts, float side, const PersonState& state, Carrying carrying, double time_s,
              const Eigen::Vector3f& shoulder) const;
  /// @param along  unit vector from the wrist to the finger tips
  void addHand(Primitives& parts, float side, const Eigen::Vector3f& wrist, const Eigen::Vector3f& along) const;
  void addTorso(Primitives& parts, float hip_z) const;
  void addHead(Primitives& parts, const Eigen::Vector3f& neck, double time_s) const;

  double height_m_;
  float build_, shoulder_, belly_;
  float idle_phase_, seat_height_m_ = 0.47F, sit_lean_rad_, head_scale_;
  bool long_sleeves_, long_hair_, skirt_, bald_, coat_;
  std::uint64_t gesture_;
  Look look_{};
};

}  // namespace semantic_vslam::synthetic
