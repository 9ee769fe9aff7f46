// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "eval/synthetic/walker.h"

#include <algorithm>
#include <cmath>

#include "core/common/rng.h"
#include "eval/synthetic/patterns.h"

namespace semantic_vslam::synthetic {
namespace {

using Eigen::Vector3f;

constexpr double kStepS = 0.01;
constexpr double kAccelerationMps2 = 1.6, kTurnRateRadPs = 2.6, kSitSeconds = 1.2;
constexpr double kStrideLengthM = 1.45;  // two steps

double wrapAngle(double angle) { return std::remainder(angle, 2.0 * M_PI); }

/// Plays a script step by step.
class Puppeteer {
 public:
  explicit Puppeteer(const PersonSpec& spec) : spec_(spec) {
    state_.position_m = spec.start_m;
    state_.heading_rad = spec.heading_rad;
    state_.seated = spec.seated ? 1.0 : 0.0;
  }
  const PersonState& state() const { return state_; }

  void step() {
    double wanted_speed = 0.0;
    while (next_ < spec_.script.size() && actionDone(spec_.script[next_])) {
      ++next_;
      waited_s_ = 0.0;
    }
    if (next_ < spec_.script.size()) wanted_speed = act(spec_.script[next_]);
    const double change = std::clamp(wanted_speed - speed_, -kAccelerationMps2 * kStepS, kAccelerationMps2 * kStepS);
    speed_ += change;
    state_.position_m += speed_ * kStepS * Eigen::Vector2d(std::cos(state_.heading_rad), std::sin(state_.heading_rad));
    state_.stride = std::clamp(speed_ / 1.1, 0.0, 1.2);
    state_.stride_rad += 2.0 * M_PI * speed_ * kStepS / kStrideLengthM;
  }

 private:
  bool actionDone(const PersonAction& action) const {
    switch (action.kind) {
      case PersonAction::Kind::kWalkTo: return (action.target_m - state_.position_m).norm() < stoppingDistance() + 0.03;
      case PersonAction::Kind::kWait: return waited_s_ >= action.seconds;
      case PersonAction::Kind::kTurnTo: return std::abs(wrapAngle(action.heading_rad - state_.heading_rad)) < 0.02;
      case PersonAction::Kind::kSit: return state_.seated >= 1.0;
      case PersonAction::Kind::kStandUp: return state_.seated <= 0.0;
    }
    return true;
  }

  /// Way to go before a stop; none where the next action walks on.
  double stoppingDistance() const {
    const bool walks_on =
        next_ + 1 < spec_.script.size() && spec_.script[next_ + 1].kind == PersonAction::Kind::kWalkTo;
    return walks_on ? 0.25 : speed_ * speed_ / (2.0 * kAccelerationMps2);
  }

  void turnTowards(double heading_rad) {
    const double error = wrapAngle(heading_rad - state_.heading_rad);
    const double rate = std::clamp(4.0 * error, -kTurnRateRadPs, kTurnRateRadPs);
    state_.heading_rad += rate * kStepS;
  }

  /// @return wanted speed, m/s
  double act(const PersonAction& action) {
    switch (action.kind) {
      case PersonAction::Kind::kWalkTo: {
        const Eigen::Vector2d way = action.target_m - state_.position_m;
        const double heading = std::atan2(way.y(), way.x());
        turnTowards(heading);
        const double error = std::abs(wrapAngle(heading - state_.heading_rad));
        return spec_.speed_mps * std::clamp(1.2 - error, 0.0, 1.0);
      }
      case PersonAction::Kind::kWait: waited_s_ += kStepS; break;
      case PersonAction::Kind::kTurnTo: turnTowards(action.heading_rad); break;
      case PersonAction::Kind::kSit: state_.seated = std::min(1.0, state_.seated + kStepS / kSitSeconds); break;
      case PersonAction::Kind::kStandUp: state_.seated = std::max(0.0, state_.seated - kStepS / kSitSeconds); break;
    }
    return 0.0;
  }

  const PersonSpec& spec_;
  PersonState state_;
  std::size_t next_ = 0;
  double waited_s_ = 0.0, speed_ = 0.0;
};

/// Point `length` away from a joint; angle 0 hangs down, positive swings forward.
Vector3f swing(const Vector3f& joint, float length, float angle_rad, float sideways = 0.0F) {
  return joint + length * Vector3f(std::sin(angle_rad), sideways, -std::cos(angle_rad)).normalized();
}

float smoothStep(double x) {
  const double c = std::clamp(x, 0.0, 1.0);
  return static_cast<float>(c * c * (3.0 - 2.0 * c));
}

cv::Mat3b clothPattern(const cv::Scalar& color, Rng& rng) {
  switch (rng.below(6)) {
    case 0: return plaid(color, rng);
    case 1: return stripes(color, rng);
    case 2: return dots(color, rng);
    case 3: return printedShirt(color, rng);
    default: return plainCloth(color, rng);
  }
}

}  // namespace

PersonMotion::PersonMotion(const PersonSpec& spec, double duration_s) {
  Puppeteer puppeteer(spec);
  const auto steps = static_cast<std::size_t>(std::ceil(duration_s / kStepS)) + 2;
  states_.reserve(steps);
  for (std::size_t i = 0; i < steps; ++i) {
    states_.push_back(puppeteer.state());
    puppeteer.step();
  }
}

PersonState PersonMotion::at(double time_s) const {
  const double position = std::clamp(time_s / kStepS, 0.0, static_cast<double>(states_.size()) - 1.001);
  const auto i = static_cast<std::size_t>(position);
  const double part = position - static_cast<double>(i);
  const PersonState &a = states_[i], &b = states_[i + 1];
  const auto blend = [part](double from, double to) { return from + part * (to - from); };
  return {a.position_m + part * (b.position_m - a.position_m), blend(a.heading_rad, b.heading_rad),
          blend(a.stride_rad, b.stride_rad), blend(a.stride, b.stride), blend(a.seated, b.seated)};
}

PersonBody::PersonBody(Scene& scene, std::uint64_t look_seed) {
  Rng rng(look_seed);
  const auto between = [&](double low, double high) { return static_cast<float>(rng.uniform(low, high)); };
  height_m_ = rng.uniform(1.56, 1.90);
  build_ = between(0.88, 1.18);
  shoulder_ = between(0.108, 0.125);
  belly_ = between(0.9, 1.25);
  head_scale_ = between(0.95, 1.05);
  idle_phase_ = between(0, 6.28);
  sit_lean_rad_ = between(-0.1, 0.25);
  long_sleeves_ = rng.below(2) == 0;
  long_hair_ = rng.below(5) < 2;
  skirt_ = rng.below(7) == 0;
  bald_ = rng.below(10) == 0;
  coat_ = rng.below(6) == 0;
  gesture_ = rng.below(4);

  const auto material = [&](const cv::Mat3b& texture, float repeat_m, float gloss = 0.0F) {
    Material m;
    m.texture = scene.addTexture(texture);
    m.repeat_m = repeat_m;
    m.gloss = gloss;
    return scene.addMaterial(m);
  };
  const double skin_tone = rng.uniform(0.32, 1.0);
  const cv::Scalar skin_color(135 * skin_tone + 10, 165 * skin_tone + 10, 215 * skin_tone + 12);
  const cv::Scalar hair_tones[] = {{25, 25, 28}, {35, 55, 85}, {60, 110, 160}, {140, 145, 150}, {30, 45, 110}};
  const cv::Scalar hair_color = hair_tones[rng.below(5)];
  look_.skin = material(synthetic::skin(skin_color, rng), 0.2F, 0.05F);
  look_.head = material(face(skin_color, hair_color, rng), 0.0F, 0.06F);
  look_.hair = material(synthetic::hair(hair_color, rng), 0.25F, 0.1F);
  const cv::Scalar shirt_color = randomColor(rng, 10, 220, 50, 235);
  look_.shirt = material(clothPattern(shirt_color, rng), between(0.35, 0.6));
  look_.sleeves = rng.below(5) == 0 ? material(plainCloth(randomColor(rng, 10, 200, 50, 230), rng), 0.4F) : look_.shirt;
  const cv::Scalar denim_color(rng.uniform(70, 150), rng.uniform(50, 100), rng.uniform(30, 80));
  const bool jeans = rng.below(2) == 0;
  const cv::Mat3b legs = jeans ? denim(denim_color, rng) : plainCloth(randomColor(rng, 5, 120, 30, 190), rng);
  look_.trousers = material(legs, 0.45F);
  look_.shoes = material(plastic(randomColor(rng, 0, 160, 25, 225), rng), 0.1F, 0.1F);
  look_.belt = material(plastic(cv::Scalar::all(rng.uniform(25, 70)), rng), 0.1F, 0.2F);
}

PersonBody::Legs PersonBody::poseLeg(float side, const PersonState& state) const {
  const auto h = static_cast<float>(height_m_);
  const double phase = state.stride_rad + (side > 0 ? 0.0 : M_PI);
  const auto stride = static_cast<float>(state.stride);
  const float seated = smoothStep(state.seated);
  // Hip swings like a sine; the knee bends most while the leg comes forward.
  float hip_rad = 0.42F * stride * static_cast<float>(std::sin(phase)) + 0.05F * stride;
  float knee_rad = stride * (0.12F + 0.85F * static_cast<float>(std::pow(std::max(0.0, std::cos(phase + 0.35)), 2.0)));
  hip_rad = (1 - seated) * hip_rad + seated * 1.5F;
  knee_rad = (1 - seated) * knee_rad + seated * 1.55F;
  Legs leg;
  leg.hip = {0, side * 0.052F * h * build_, 0};
  leg.knee = swing(leg.hip, 0.245F * h, hip_rad, side * 0.03F * (1 + 3 * seated));
  leg.ankle = swing(leg.knee, 0.24F * h, hip_rad - knee_rad);
  leg.foot_pitch_rad = (1 - seated) * (0.75F * (hip_rad - knee_rad));
  return leg;
}

void PersonBody::addLeg(Primitives& parts, const Legs& leg) const {
  const auto h = static_cast<float>(height_m_);
  const float wide = build_ * (coat_ ? 1.0F : 1.05F);
  parts.push_back(makeRoundedCone(leg.hip, 0.050F * h * wide, leg.knee, 0.034F * h * wide, look_.trousers, kPerson));
  const int shin = skirt_ ? look_.skin : look_.trousers;
  const float cuff = skirt_ ? 0.020F : 0.029F;
  parts.push_back(
      makeRoundedCone(leg.knee, (skirt_ ? 0.028F : 0.034F) * h * wide, leg.ankle, cuff * h * wide, shin, kPerson));
  const Vector3f heel = leg.ankle + Vector3f(-0.012F * h, 0, -0.018F * h);
  const Vector3f toe = leg.ankle +
                       0.095F * h * Vector3f(std::cos(leg.foot_pitch_rad), 0, std::sin(leg.foot_pitch_rad)) +
                       Vector3f(0, 0, -0.020F * h);
  parts.push_back(makeRoundedCone(heel, 0.022F * h, toe, 0.018F * h, look_.shoes, kPerson));
}

void PersonBody::addTorso(Primitives& parts, float hip_z) const {
  const auto h = static_cast<float>(height_m_);
  const float wide = build_, bulk = coat_ ? 1.1F : 1.0F;
  const Vector3f hips(0, 0, hip_z + 0.015F * h), waist(0, 0, hip_z + 0.085F * h),
      chest(0.004F * h, 0, hip_z + 0.215F * h);
  parts.push_back(makeEllipsoid(hips, Vector3f(0.068F * wide, 0.098F * wide, 0.07F) * h, look_.trousers, kPerson));
  // The trunk from waist to chest, the breast up to the shoulders, and the shoulders with the slope of the neck.
  const float waist_r = (0.082F + 0.010F * belly_) * wide * bulk, chest_r = 0.099F * wide * bulk;
  parts.push_back(makeRoundedCone(waist - Vector3f(-0.004F * belly_ * h, 0, 0.04F * h), waist_r * h, chest, chest_r * h,
                                  look_.shirt, kPerson, 0.52F + 0.14F * belly_));
  const float shoulder_z = hip_z + 0.270F * h, reach = 0.78F * shoulder_ * h;
  parts.push_back(
      makeRoundedCone({0, -reach, shoulder_z}, 0.034F * h, {0, reach, shoulder_z}, 0.034F * h, look_.shirt, kPerson));
  for (const float side : {-1.0F, 1.0F}) {
    parts.push_back(makeRoundedCone({0, side * reach, shoulder_z + 0.004F * h}, 0.030F * h,
                                    {-0.006F * h, side * 0.02F * h, shoulder_z + 0.032F * h}, 0.028F * h, look_.shirt,
                                    kPerson));
  }
  parts.push_back(makeRoundedCone({0.004F * h, 0, hip_z + 0.225F * h}, 0.088F * h * wide,
                                  {0, 0, shoulder_z + 0.004F * h}, 0.056F * h, look_.shirt, kPerson, 0.66F));
  parts.push_back(makeFrustum({0, 0, hip_z + 0.02F * h}, 0.0F, 0.0F, 0.02F * h, look_.belt, kPerson));
  parts.back().radius_start = parts.back().radius_end = 0.096F * h * wide * bulk;
  parts.back().scale.x() = 0.71F;
}

void PersonBody::addHead(Primitives& parts, const Vector3f& neck, double time_s) const {
  const auto h = static_cast<float>(height_m_);
  const float s = head_scale_ * h;
  parts.push_back(
      makeRoundedCone(neck, 0.030F * h, neck + Vector3f(0.008F * h, 0, 0.05F * h), 0.028F * h, look_.skin, kPerson));
  Primitives head{
      makeEllipsoid({0, 0, 0}, Vector3f(0.054F, 0.044F, 0.067F) * s, look_.head, kPerson),
      makeEllipsoid(Vector3f(0.053F, 0, -0.004F) * s, Vector3f(0.010F, 0.007F, 0.012F) * s, look_.skin, kPerson)};
  for (const float side : {-1.0F, 1.0F}) {
    head.push_back(makeEllipsoid(Vector3f(-0.004F, side * 0.044F, -0.002F) * s, Vector3f(0.011F, 0.006F, 0.017F) * s,
                                 look_.skin, kPerson));
  }
  if (!bald_) {
    head.push_back(
        makeEllipsoid(Vector3f(-0.012F, 0, 0.020F) * s, Vector3f(0.055F, 0.049F, 0.057F) * s, look_.hair, kPerson));
    if (long_hair_) {
      head.push_back(makeRoundedCone(Vector3f(-0.022F, 0, 0.015F) * s, 0.047F * s, Vector3f(-0.036F, 0, -0.085F) * s,
                                     0.037F * s, look_.hair, kPerson, 0.62F));
    }
  }
  Eigen::Isometry3f T = Eigen::Isometry3f::Identity();
  T.translation() = neck + Vector3f(0.014F * h, 0, 0.103F * h);
  const auto turn = static_cast<float>(0.22 * std::sin(0.7 * time_s + idle_phase_));
  const auto nod = static_cast<float>(0.07 * std::sin(1.1 * time_s + 2.0 * idle_phase_));
  T.linear() =
      (Eigen::AngleAxisf(turn, Vector3f::UnitZ()) * Eigen::AngleAxisf(nod, Vector3f::UnitY())).toRotationMatrix();
  append(parts, placed(head, T));
}

void PersonBody::addHand(Primitives& parts, float side, const Vector3f& wrist, const Vector3f& along) const {
  const auto h = static_cast<float>(height_m_);
  const Vector3f forward = Vector3f(along.z(), 0, -along.x()).normalized() * -1.0F;  // the thumb's side
  const Vector3f palm = wrist + 0.038F * h * along, bend = 0.010F * h * Vector3f(0, -side, 0);
  parts.push_back(makeRoundedCone(wrist, 0.015F * h, palm, 0.021F * h, look_.skin, kPerson, 0.5F, Vector3f::UnitY()));
  for (const float finger : {-1.0F, 0.0F, 1.0F}) {
    const Vector3f knuckle = palm + finger * 0.012F * h * forward;
    const Vector3f joint = knuckle + 0.026F * h * along + 0.4F * bend;
    parts.push_back(makeRoundedCone(knuckle, 0.0075F * h, joint, 0.0065F * h, look_.skin, kPerson));
    parts.push_back(
        makeRoundedCone(joint, 0.0065F * h, joint + 0.018F * h * along + bend, 0.0055F * h, look_.skin, kPerson));
  }
  parts.push_back(makeRoundedCone(wrist + 0.012F * h * (along + forward), 0.009F * h,
                                  wrist + 0.036F * h * along + 0.024F * h * forward, 0.0065F * h, look_.skin, kPerson));
}

void PersonBody::addArm(Primitives& parts, float side, const PersonState& state, Carrying carrying, double time_s,
                        const Vector3f& shoulder) const {
  const auto h = static_cast<float>(height_m_);
  const auto stride = static_cast<float>(state.stride);
  const float seated = smoothStep(state.seated);
  const double phase = state.stride_rad + (side > 0 ? M_PI : 0.0);  // against the leg of the same side
  float upper_rad = 0.38F * stride * static_cast<float>(std::sin(phase));
  float bend_rad = 0.18F + stride * (0.22F + 0.18F * static_cast<float>(std::sin(phase)));
  float outward = 0.10F + 0.04F * build_, inward = 0.0F;
  // Standing or seated people gesture with one hand, slowly.
  const auto wave = static_cast<float>(0.5 + 0.5 * std::sin(1.3 * time_s + idle_phase_ + side));
  const bool gestures = (gesture_ == 1 && side > 0) || (gesture_ == 2 && side < 0) || gesture_ == 3;
  const float quiet = 1.0F - std::min(1.0F, 2.0F * stride);
  if (gestures) {
    upper_rad += quiet * 0.45F * wave;
    bend_rad += quiet * (0.7F + 0.8F * wave);
    inward = 0.25F * quiet;
  }
  upper_rad = (1 - seated) * upper_rad + seated * (0.55F + 0.25F * wave);
  bend_rad = (1 - seated) * bend_rad + seated * (0.95F + (gestures ? 0.5F * wave : 0.0F));
  if (carrying == Carrying::kBox) {
    upper_rad = 0.25F;
    bend_rad = 1.25F;
    outward = 0.12F;
  } else if (carrying == Carrying::kPushing) {
    upper_rad = 0.55F;
    bend_rad = 0.55F;
    outward = 0.10F;
  }
  const Vector3f elbow = swing(shoulder, 0.17F * h, upper_rad, side * outward);
  const Vector3f wrist = swing(elbow, 0.145F * h, upper_rad + bend_rad, -side * inward);
  const Vector3f hand = swing(wrist, 0.045F * h, upper_rad + bend_rad + 0.15F);
  const float sleeve = long_sleeves_ ? 1.12F : 1.0F;
  parts.push_back(
      makeRoundedCone(shoulder, 0.032F * h * build_, elbow, 0.026F * h * build_ * sleeve, look_.sleeves, kPerson));
  parts.push_back(makeRoundedCone(elbow, 0.025F * h * build_ * sleeve, wrist, 0.018F * h * build_ * sleeve,
                                  long_sleeves_ ? look_.sleeves : look_.skin, kPerson));
  addHand(parts, side, wrist, (hand - wrist).normalized());
}

Primitives PersonBody::pose(const PersonState& state, Carrying carrying, double time_s) const {
  const auto h = static_cast<float>(height_m_);
  const float seated = smoothStep(state.seated);
  Legs legs[2] = {poseLeg(1.0F, state), poseLeg(-1.0F, state)};
  // The lower foot stands on the floor; a seated body rests on the seat.
  const float lowest = std::min(legs[0].ankle.z(), legs[1].ankle.z());
  const float hip_z = (1 - seated) * (0.040F * h - lowest) + seated * (seat_height_m_ + 0.055F * h);
  Primitives parts;
  for (Legs& leg : legs) {
    for (Vector3f* joint : {&leg.hip, &leg.knee, &leg.ankle}) joint->z() += hip_z;
    addLeg(parts, leg);
  }
  Primitives upper;
  addTorso(upper, 0.0F);
  const Vector3f neck(-0.004F * h, 0, 0.292F * h);
  addHead(upper, neck, time_s);
  for (const float side : {-1.0F, 1.0F}) {
    addArm(upper, side, state, carrying, time_s, {0, side * shoulder_ * h, 0.262F * h});
  }
  // The trunk leans a little into the walk, turns against the legs and sways.
  const auto stride = static_cast<float>(state.stride);
  const float lean = 0.04F + 0.05F * stride + seated * sit_lean_rad_ + (carrying == Carrying::kPushing ? 0.18F : 0.0F);
  const float twist = 0.10F * stride * static_cast<float>(std::sin(state.stride_rad));
  const float sway = 0.03F * stride * static_cast<float>(std::cos(state.stride_rad)) +
                     0.008F * static_cast<float>(std::sin(0.9 * time_s + idle_phase_));
  Eigen::Isometry3f T_body_trunk = Eigen::Isometry3f::Identity();
  T_body_trunk.translation() = Vector3f(0, 0, hip_z);
  T_body_trunk.linear() = (Eigen::AngleAxisf(-twist, Vector3f::UnitZ()) * Eigen::AngleAxisf(sway, Vector3f::UnitX()) *
                           Eigen::AngleAxisf(lean, Vector3f::UnitY()))
                              .toRotationMatrix();
  append(parts, placed(upper, T_body_trunk));
  if (skirt_ || coat_) {
    const float hem_z = hip_z - (coat_ ? 0.17F : 0.20F) * h * (1 - 0.6F * seated);
    Primitive hem = makeFrustum({0, 0, hem_z}, (0.115F + 0.02F * stride) * h * build_, 0.097F * h * build_,
                                hip_z + 0.03F * h - hem_z, coat_ ? look_.shirt : look_.trousers, kPerson);
    hem.scale.x() = 0.85F;
    if (seated < 0.3F) parts.push_back(hem);
  }
  Eigen::Isometry3f T_world_body = Eigen::Isometry3f::Identity();
  T_world_body.translation() =
      Vector3f(static_cast<float>(state.position_m.x()), static_cast<float>(state.position_m.y()), 0);
  T_world_body.linear() =
      Eigen::AngleAxisf(static_cast<float>(state.heading_rad), Vector3f::UnitZ()).toRotationMatrix();
  return placed(parts, T_world_body);
}

}  // namespace semantic_vslam::synthetic
