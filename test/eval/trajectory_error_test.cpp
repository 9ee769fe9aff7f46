// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "eval/trajectory_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

/// A curved path of 10 s at 10 Hz.
std::vector<TimedPose> curvedPath() {
  std::vector<TimedPose> poses;
  for (int i = 0; i <= 100; ++i) {
    const double t = 0.1 * i;
    TimedPose pose;
    pose.stamp = Stamp::fromSeconds(1000.0 + t);
    pose.T_world_camera = makeSE3(Eigen::Quaterniond(so3Exp({0.1 * t, 0.05 * t, 0.2 * std::sin(t)})),
                                  {std::cos(t), std::sin(t), 0.1 * t});
    poses.push_back(pose);
  }
  return poses;
}

TEST(ErrorStatistics, MatchHandComputedNumbers) {
  const ErrorStatistics s = statisticsOf({4.0, 1.0, 1.0, 2.0});
  EXPECT_EQ(s.count, 4U);
  EXPECT_DOUBLE_EQ(s.mean, 2.0);
  EXPECT_DOUBLE_EQ(s.median, 1.5);
  EXPECT_DOUBLE_EQ(s.rmse, std::sqrt(22.0 / 4.0));
  EXPECT_DOUBLE_EQ(s.stddev, std::sqrt(6.0 / 4.0));
  EXPECT_DOUBLE_EQ(s.min, 1.0);
  EXPECT_DOUBLE_EQ(s.max, 4.0);
}

TEST(AbsoluteTrajectoryError, IsZeroForTheSamePathInAnotherFrame) {
  const auto truth = curvedPath();
  auto estimate = truth;
  const SE3 T_other_world = se3Exp((Vector6d() << 5, -3, 1, 0.3, 2.0, -1.0).finished());
  for (auto& pose : estimate) pose.T_world_camera = T_other_world * pose.T_world_camera;
  const auto error = absoluteTrajectoryError(truth, estimate);
  EXPECT_EQ(error.translation_m.count, truth.size());
  EXPECT_LT(error.translation_m.max, 1e-9);
  EXPECT_TRUE(error.truth_from_estimate.T_target_source.isApprox(T_other_world.inverse(), 1e-9));
}

TEST(AbsoluteTrajectoryError, AlternatingOffsetIsItsOwnError) {
  const auto truth = curvedPath();
  auto estimate = truth;
  estimate.pop_back();  // an even count, so that the offsets cancel in the alignment
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    estimate[i].T_world_camera.translation().z() += i % 2 == 0 ? 0.01 : -0.01;
  }
  const auto error = absoluteTrajectoryError(truth, estimate);
  EXPECT_NEAR(error.translation_m.rmse, 0.01, 2e-5);
  EXPECT_EQ(error.matches.size(), estimate.size());
  EXPECT_EQ(error.matches[3].stamp, estimate[3].stamp);
}

TEST(AbsoluteTrajectoryError, AlignsScaleOnlyIfAsked) {
  const auto truth = curvedPath();
  auto estimate = truth;
  for (auto& pose : estimate) pose.T_world_camera.translation() *= 2.0;
  EXPECT_GT(absoluteTrajectoryError(truth, estimate).translation_m.rmse, 0.5);
  EXPECT_LT(absoluteTrajectoryError(truth, estimate, kAssociationGapS, true).translation_m.rmse, 1e-9);
}

TEST(AbsoluteTrajectoryError, RecordingsOfDifferentTimesAreRefused) {
  const auto truth = curvedPath();
  auto estimate = truth;
  for (auto& pose : estimate) pose.stamp.ns += 3600'000'000'000;
  EXPECT_THROW(absoluteTrajectoryError(truth, estimate), Error);
  EXPECT_THROW(absoluteTrajectoryError(truth, {}), Error);
}

TEST(RelativePoseError, MeasuresDriftPerDeltaInsensitiveToTheFrame) {
  // The estimate drifts along its own x by 1 cm and about its own z by 0.5 degrees each second (1 mm, 0.05 deg a step).
  std::vector<TimedPose> truth(101), estimate(101);
  const double step_rad = 0.05 * M_PI / 180.0;
  for (int i = 0; i <= 100; ++i) {
    truth[i].stamp = estimate[i].stamp = Stamp::fromSeconds(50.0 + 0.1 * i);
    estimate[i].T_world_camera = se3Exp((Vector6d() << 0.001, 0, 0, 0, 0, step_rad).finished() * i);
  }
  const auto error = relativePoseError(truth, estimate, 1.0);
  EXPECT_NEAR(error.translation_m.rmse, 0.01, 1e-6);
  EXPECT_NEAR(error.rotation_deg.rmse, 0.5, 1e-6);
  // Poses 0..89 have a partner 10 steps on that is not the last pose.
  EXPECT_EQ(error.translation_m.count, 90U);
}

TEST(RelativePoseError, LeavesOutPairsWithoutATruePoseCloseInTime) {
  const auto estimate = curvedPath();
  auto truth = estimate;
  truth.erase(truth.begin() + 40, truth.begin() + 60);  // 2 s without ground truth, whose interval is 0.1 s
  const auto error = relativePoseError(truth, estimate, 1.0);
  // Missing 40..59, of which 40, 41 and 58, 59 are within two intervals of a true pose: 16 poses have none. As begin
  // and as end, 16 + 16 - 6 that are both (42..47 end in 52..57) drop out.
  EXPECT_EQ(error.translation_m.count, 90U - 26U);
  EXPECT_THROW(relativePoseError({}, estimate, 1.0), Error);
  EXPECT_THROW(relativePoseError(truth, {estimate[0]}, 1.0), Error);
}

struct PublishedResult {
  const char* sequence;
  double ate_rmse_m, rpe_translation_m, rpe_rotation_deg;
};

class PublishedTrajectory : public testing::TestWithParam<PublishedResult> {};

TEST_P(PublishedTrajectory, GivesThePublishedNumbers) {
  const char* shared = std::getenv("SEMANTIC_VSLAM_SHARED");
  const std::string folder = std::string(shared != nullptr ? shared : "../shared") + "/data/tum_dynamic_reference/";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no reference trajectories at " << folder;
  const PublishedResult expected = GetParam();
  const auto truth = readTumTrajectory(folder + expected.sequence + "_groundtruth.txt");
  const auto estimate = readTumTrajectory(folder + expected.sequence + "_estimate.txt");
  EXPECT_NEAR(absoluteTrajectoryError(truth, estimate).translation_m.rmse, expected.ate_rmse_m, 5e-5);
  const auto relative = relativePoseError(truth, estimate, 1.0);
  EXPECT_NEAR(relative.translation_m.rmse, expected.rpe_translation_m, 0.01 * expected.rpe_translation_m);
  EXPECT_NEAR(relative.rotation_deg.rmse, expected.rpe_rotation_deg, 0.01 * expected.rpe_rotation_deg);
}

INSTANTIATE_TEST_SUITE_P(TumDynamic, PublishedTrajectory,
                         testing::Values(PublishedResult{"fr3_sitting_static", 0.0064, 0.0082, 0.281},
                                         PublishedResult{"fr3_walking_xyz", 0.0163, 0.0218, 0.618}),
                         [](const auto& info) { return std::string(info.param.sequence); });

}  // namespace
}  // namespace semantic_vslam
