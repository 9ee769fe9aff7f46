// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "eval/synthetic_room.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <set>
#include <thread>

#include "core/camera/depth_quantum.h"
#include "core/support/quarter_vga.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

CameraIntrinsics distortedCamera() {
  CameraIntrinsics k = quarterVga();
  k.distortion = {0.262383, -0.953104, -0.005358, 0.002628, 1.163314};
  return k;
}

synthetic::SensorModel idealSensor() {
  synthetic::SensorModel sensor;
  sensor.depth_noise = sensor.depth_range = sensor.depth_holes = false;
  sensor.color_noise = sensor.blur_px = 0.0;
  return sensor;
}

bool sameBytes(const cv::Mat& a, const cv::Mat& b) {
  if (a.size() != b.size() || a.type() != b.type()) return false;
  return std::equal(a.datastart, a.dataend, b.datastart);
}

bool sameFrame(const SyntheticFrame& a, const SyntheticFrame& b) {
  return sameBytes(a.frame.bgr, b.frame.bgr) && sameBytes(a.frame.depth_m, b.frame.depth_m) &&
         sameBytes(a.true_depth_m, b.true_depth_m) && sameBytes(a.labels, b.labels) &&
         sameBytes(a.moving_mask, b.moving_mask) && a.T_world_camera.matrix() == b.T_world_camera.matrix();
}

double share(const cv::Mat1b& mask) {
  return static_cast<double>(cv::countNonZero(mask)) / static_cast<double>(mask.total());
}

TEST(SyntheticRoom, GivesTheSameBytesForTheSameSeedInAnyOrderAndFromAnyThread) {
  const Scenario scenario = makeScenario("walking", 3, 10.0);
  const SyntheticRoom first(scenario, quarterVga()), second(scenario, quarterVga());
  const SyntheticFrame a = first.render(4.0);
  second.render(7.5);
  SyntheticFrame b, c;
  std::thread one([&] { b = second.render(4.0); });
  std::thread two([&] { c = second.render(4.0); });
  one.join();
  two.join();
  EXPECT_TRUE(sameFrame(a, b));
  EXPECT_TRUE(sameFrame(a, c));
}

TEST(SyntheticRoom, LooksDifferentForEachOfTwentySeeds) {
  std::vector<cv::Mat1b> seen;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const SyntheticRoom room(makeScenario("walking", seed, 6.0), quarterVga());
    const SyntheticFrame frame = room.render(3.0);
    for (const auto& other : seen)
      EXPECT_GT(cv::norm(frame.frame.gray, other, cv::NORM_L1) / static_cast<double>(other.total()), 12.0);
    seen.push_back(frame.frame.gray);
  }
}

/// Median and 90th percentile of the colour difference of points of frame a that frame b shows too.
std::pair<double, double> colorErrorAfterReprojection(const SyntheticFrame& a, const SyntheticFrame& b, int& compared) {
  const CameraModel& camera = *a.frame.camera;
  const SE3 T_b_a = b.T_world_camera.inverse() * a.T_world_camera;
  std::vector<double> errors;
  for (int v = 2; v < camera.height() - 2; v += 2) {
    for (int u = 2; u < camera.width() - 2; u += 2) {
      const cv::Vec2f& ray = camera.rays()(v, u);
      const double z_m = a.true_depth_m(v, u);
      const Eigen::Vector3d in_b = T_b_a * Eigen::Vector3d(ray[0] * z_m, ray[1] * z_m, z_m);
      if (in_b.z() < 0.1) continue;
      const Eigen::Vector2d px = camera.projectRaw(in_b);
      if (!camera.contains(px, 2.0)) continue;
      const int ub = cvRound(px.x()), vb = cvRound(px.y());
      // Slack of a centimetre and a pixel's slant; beyond it the point is hidden in b.
      if (std::abs(b.true_depth_m(vb, ub) - in_b.z()) > 0.01 + 0.02 * in_b.z()) continue;
      cv::Mat3b patch;
      cv::getRectSubPix(b.frame.bgr, {1, 1}, cv::Point2f(static_cast<float>(px.x()), static_cast<float>(px.y())),
                        patch);
      errors.push_back(cv::norm(cv::Vec3d(a.frame.bgr(v, u)) - cv::Vec3d(patch(0)), cv::NORM_L1) / 3.0);
    }
  }
  compared = static_cast<int>(errors.size());
  std::sort(errors.begin(), errors.end());
  if (errors.empty()) return {255, 255};
  return {errors[errors.size() / 2], errors[errors.size() * 9 / 10]};
}

TEST(SyntheticRoom, ShowsAPointInTwoFramesWhereDepthAndPosesSayItIs) {
  for (const CameraIntrinsics& intrinsics : {quarterVga(), distortedCamera()}) {
    Scenario scenario = makeScenario("static", 5, 10.0);
    scenario.sensor = idealSensor();
    const SyntheticRoom room(scenario, intrinsics);
    const SyntheticFrame a = room.render(2.0), b = room.render(3.5);
    EXPECT_GT((a.T_world_camera.inverse() * b.T_world_camera).translation().norm(), 0.05);
    int compared = 0;
    const auto [median, high] = colorErrorAfterReprojection(a, b, compared);
    EXPECT_GT(compared, 5000);
    EXPECT_LT(median, 2.0);
    EXPECT_LT(high, 12.0);
    // The same with a pose that is 2 cm off must be worse: the test can tell.
    SyntheticFrame moved = b;
    moved.T_world_camera.translation().y() += 0.02;
    EXPECT_GT(colorErrorAfterReprojection(a, moved, compared).second, 1.5 * high);
  }
}

TEST(SyntheticRoom, HasMasksThatAgreeWithEachOtherAndWithDepth) {
  Scenario scenario = makeScenario("walking", 2, 20.0);
  scenario.sensor = idealSensor();
  Scenario empty = scenario;
  empty.people.clear();
  const SyntheticRoom room(scenario, quarterVga()), empty_room(empty, quarterVga());
  double person_share = 0.0;
  for (double t = 2.0; t < 20.0; t += 3.0) {
    const SyntheticFrame frame = room.render(t), without = empty_room.render(t);
    person_share = std::max(person_share, share(frame.person_mask));
    EXPECT_EQ(cv::countNonZero((frame.labels == synthetic::kPerson) != frame.person_mask), 0);
    for (int v = 0; v < frame.labels.rows; ++v) {
      for (int u = 0; u < frame.labels.cols; ++u) {
        if (frame.person_mask(v, u))
          EXPECT_LE(frame.true_depth_m(v, u), without.true_depth_m(v, u));
        else
          EXPECT_EQ(frame.true_depth_m(v, u), without.true_depth_m(v, u));
      }
    }
  }
  EXPECT_GT(person_share, 0.1);
}

TEST(SyntheticRoom, CallsAPersonWhoPausesStillAndAPushedChairMoving) {
  const SyntheticRoom chair(makeScenario("pushed_chair", 1), quarterVga());
  const SyntheticFrame pushed = chair.render(4.0);
  const cv::Mat1b moving_chair = (pushed.labels == synthetic::kChair) & pushed.moving_mask;
  EXPECT_GT(share(moving_chair), 0.01);

  const SyntheticFrame left_alone = chair.render(14.0);
  EXPECT_EQ(cv::countNonZero((left_alone.labels == synthetic::kChair) & left_alone.moving_mask), 0);

  const SyntheticRoom pause(makeScenario("pause", 1), quarterVga());
  const SyntheticFrame paused = pause.render(3.0);
  EXPECT_GT(share(paused.person_mask), 0.05);
  EXPECT_LT(share(paused.moving_mask), 0.1 * share(paused.person_mask));

  const SyntheticRoom empty(makeScenario("static", 1), quarterVga());
  EXPECT_EQ(cv::countNonZero(empty.render(3.0).moving_mask), 0);
}

TEST(SyntheticRoom, GivesOrbPlentyOfFeaturesSpreadOverTheImage) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const SyntheticRoom room(makeScenario("static", seed), CameraIntrinsics{});
    const SyntheticFrame frame = room.render(4.0);
    std::vector<cv::KeyPoint> keypoints;
    cv::ORB::create(2000)->detect(frame.frame.gray, keypoints);
    EXPECT_GE(keypoints.size(), 1000U) << "seed " << seed;
    std::vector<cv::KeyPoint> corners;  // the detector alone, without ORB's preference for the strongest
    cv::FAST(frame.frame.gray, corners, 20);
    std::set<int> cells;
    for (const auto& corner : corners)
      cells.insert(static_cast<int>(corner.pt.y) / 80 * 8 + static_cast<int>(corner.pt.x) / 80);
    EXPECT_GE(cells.size(), 38U) << "of 48 cells, seed " << seed;
  }
}

TEST(SyntheticRoom, HasANearMoverThatCoversMostOfTheImage) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const SyntheticRoom room(makeScenario("near_mover", seed), quarterVga());
    int covered = 0;
    for (double t = 4.0; t < 15.0; t += 0.5) covered += share(room.render(t).person_mask) > 0.5 ? 1 : 0;
    EXPECT_GE(covered, 8) << "of 22 moments, seed " << seed;
  }
}

TEST(SyntheticRoom, ShowsEveryClassInAFewRandomViews) {
  std::vector<double> largest_share(synthetic::kLabelCount, 0.0);
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const SyntheticRoom room(makeRandomView(seed), quarterVga());
    const SyntheticFrame view = room.render(kRandomViewTimeS);
    double labelled = 0.0;
    for (int label = 0; label < synthetic::kLabelCount; ++label) {
      const double part = share(view.labels == label);
      labelled += part;
      largest_share[label] = std::max(largest_share[label], part);
    }
    EXPECT_DOUBLE_EQ(labelled, 1.0) << "no index outside the label set, seed " << seed;
  }
  EXPECT_EQ(syntheticLabels().size(), largest_share.size());
  for (int label = 0; label < synthetic::kLabelCount; ++label) {
    EXPECT_GT(largest_share[label], 1e-4) << syntheticLabels().classes[label].name;
  }
}

TEST(SyntheticRoom, MovesTheCameraSmoothly) {
  for (const auto& [name, description] : listScenarios()) {
    const Scenario scenario = makeScenario(name, 4);
    double fastest_mps = 0.0, fastest_turn = 0.0, way_m = 0.0;
    SE3 last = scenario.camera.at(0.0);
    for (double t = 1.0 / 30.0; t < scenario.duration_s; t += 1.0 / 30.0) {
      const SE3 now = scenario.camera.at(t), step = last.inverse() * now;
      EXPECT_NEAR((now.rotation().transpose() * now.rotation() - Eigen::Matrix3d::Identity()).norm(), 0.0, 1e-9);
      EXPECT_NEAR(now.rotation().determinant(), 1.0, 1e-9);
      way_m += step.translation().norm();
      fastest_mps = std::max(fastest_mps, step.translation().norm() * 30.0);
      fastest_turn = std::max(fastest_turn, rotationAngle(step) * 30.0);
      last = now;
    }
    EXPECT_LT(fastest_mps, 1.6) << name;
    EXPECT_LT(fastest_turn, 1.6) << name << ", rad/s";
    if (name == "loop") {
      EXPECT_GT(way_m, 30.0);
    } else if (name == "rotation") {
      EXPECT_LT(way_m, 1e-6);
    }
  }
}

TEST(SyntheticRoom, RefusesAnUnknownScenarioByNameAndListsTheOthers) {
  try {
    makeScenario("holiday", 1);
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("holiday"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("pushed_chair"), std::string::npos);
  }
}

TEST(DepthSensor, HasTheNoiseAndTheStepsOfAKinect) {
  synthetic::SensorModel sensor;
  sensor.depth_holes = false;
  for (const double z : {0.8, 1.5, 3.0}) {
    const cv::Mat1f wall(240, 320, static_cast<float>(z));
    const cv::Mat1f sensed = synthetic::senseDepth(wall, 525.0, sensor, 7);
    cv::Scalar mean, deviation;
    cv::meanStdDev(sensed, mean, deviation);
    const double step = kKinectStepPerM2 * z * z;
    EXPECT_NEAR(mean[0], z, 0.2 * step);
    // Rounding to a step adds the variance of a uniform distribution, step^2 / 12.
    const double expected = std::hypot(synthetic::kinectSigma(z), step / std::sqrt(12.0));
    EXPECT_NEAR(deviation[0], expected, 0.1 * expected) << "at " << z << " m";
    std::set<float> levels(sensed.begin(), sensed.end());
    for (auto it = levels.begin(); std::next(it) != levels.end(); ++it)
      EXPECT_NEAR(*std::next(it) - *it, step, 0.1 * step);
  }
}

TEST(DepthSensor, LeavesHolesOutOfRangeAndBesideThingsInFront) {
  cv::Mat1f scene(100, 320, 3.0F);
  scene.colRange(150, 220) = 1.0F;
  scene.rowRange(0, 10) = 6.0F;
  scene.rowRange(90, 100) = 0.3F;
  const cv::Mat1f sensed = synthetic::senseDepth(scene, 525.0, {}, 3);
  EXPECT_EQ(cv::countNonZero(sensed.rowRange(0, 7)), 0);
  EXPECT_EQ(cv::countNonZero(sensed.rowRange(93, 100)), 0);
  // f b (1/1 - 1/3) = 26 px of projector shadow on one side only.
  const cv::Mat1f band = sensed.rowRange(20, 80);
  EXPECT_LT(share(band.colRange(127, 148) > 0), 0.05);
  EXPECT_GT(share(band.colRange(223, 244) > 0), 0.95);
  EXPECT_NEAR(share(band.colRange(20, 100) > 0), 1.0 - synthetic::SensorModel().dropout_share, 0.003);
}

}  // namespace
}  // namespace semantic_vslam
