// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/motion/rigid_flow.h"
#include "core/motion/surface_evidence.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "core/common/rng.h"
#include "core/motion/depth_vote.h"
#include "core/motion/homography_motion.h"
#include "core/motion/mask_cleanup.h"

namespace semantic_vslam {
namespace {

constexpr double kStepS = 1.0 / 30.0;

/// A camera before a slanted wall with steps in depth, and the exact flow of a known motion.
class RigidScene : public ::testing::Test {
 protected:
  RigidScene()
      : grid(std::make_shared<CameraModel>(CameraIntrinsics{}), 320), previous(frameAt(0.0)), current(frameAt(0.033)) {
    Vector6d tangent;
    tangent << 0.012, -0.006, 0.015, 0.004, -0.006, 0.003;
    T_previous_current = se3Exp(tangent);
    flow = flowOf(T_previous_current);
  }

  GridFrame frameAt(double seconds) const {
    GridFrame frame;
    frame.stamp = Stamp::fromSeconds(seconds);
    frame.depth_m = cv::Mat1f(grid.size());
    for (int y = 0; y < frame.depth_m.rows; ++y) {
      for (int x = 0; x < frame.depth_m.cols; ++x) {
        const float step = ((x / 20 + y / 20) % 2 == 0) ? 0.5F : 0.0F;
        frame.depth_m(y, x) = 1.5F + 0.004F * static_cast<float>(x) + step;
      }
    }
    const cv::Mat1b kernel = cv::Mat1b::ones(3, 3);
    cv::erode(frame.depth_m, frame.depth_low_m, kernel);
    cv::dilate(frame.depth_m, frame.depth_high_m, kernel);
    frame.texture = cv::Mat1f(grid.size(), 20.0F);
    frame.gray = cv::Mat1b(grid.flowSize(), static_cast<uchar>(128));
    frame.cell_gray = cv::Mat1b(grid.size(), static_cast<uchar>(128));
    return frame;
  }

  /// Flow in cells that the scene shows under a motion, exactly.
  cv::Mat2f flowOf(const SE3& T) const {
    cv::Mat2f out(grid.size());
    const CellTransform transform(T);
    ProjectedRow before(out.cols);
    for (int y = 0; y < out.rows; ++y) {
      grid.projectRow(y, current.depth_m[y], transform, before);
      for (int x = 0; x < out.cols; ++x) {
        out(y, x) = {static_cast<float>(x) - before.x[x], static_cast<float>(y) - before.y[x]};
      }
    }
    return out;
  }

  /// Depth is that of another frame at the same place: no use as a measured previous depth.
  std::vector<FlowPoint> pointsWithoutPreviousDepth(const cv::Mat2f& measured, const cv::Mat1f& weight) const {
    auto points = selectFlowPoints(previous, current, measured, weight, grid);
    for (FlowPoint& point : points) point.depth_previous_m = 0.0F;
    return points;
  }

  WorkGrid grid;
  GridFrame previous, current;
  SE3 T_previous_current;
  cv::Mat2f flow;
  RigidFlowConfig config;
};

TEST_F(RigidScene, GridProjectsWhereItsRaysPoint) {
  for (const cv::Point cell : {cv::Point(0, 0), cv::Point(80, 60), cv::Point(159, 119)}) {
    ProjectedRow back(grid.size().width);
    grid.projectRow(cell.y, cv::Mat1f(grid.size(), 2.0F)[0], CellTransform(SE3::Identity()), back);
    EXPECT_NEAR(back.x[cell.x], cell.x, 0.05);
    EXPECT_NEAR(back.y[cell.x], cell.y, 0.05);
  }
}

TEST_F(RigidScene, CameraMotionIsRecovered) {
  const CameraMotion motion =
      estimateCameraMotion(pointsWithoutPreviousDepth(flow, {}), grid, SE3::Identity(), kStepS, config);
  ASSERT_TRUE(motion.valid);
  const SE3 error = motion.T_previous_current.inverse() * T_previous_current;
  EXPECT_LT(error.translation().norm(), 5e-4);
  EXPECT_LT(rotationAngle(error), 5e-4);
  EXPECT_GT(motion.inlier_share, 0.99);
}

TEST_F(RigidScene, MoverOverMostOfTheImageDoesNotWinAgainstThePast) {
  // 60 % of the image flows rigidly another way; the mask of the last frame knows of two thirds of it.
  Vector6d other;
  other << -0.03, 0.01, 0.0, 0.0, 0.0, 0.0;
  cv::Mat2f mixed = flow.clone();
  const cv::Rect mover(0, 0, 96, 120), known(0, 0, 64, 120);
  flowOf(se3Exp(other))(mover).copyTo(mixed(mover));
  cv::Mat1f weight(grid.size(), 1.0F);
  weight(known) = 0.02F;
  const CameraMotion motion =
      estimateCameraMotion(pointsWithoutPreviousDepth(mixed, weight), grid, T_previous_current, kStepS, config);
  ASSERT_TRUE(motion.valid);
  const SE3 error = motion.T_previous_current.inverse() * T_previous_current;
  EXPECT_LT(error.translation().norm(), 2e-3);
  EXPECT_LT(rotationAngle(error), 2e-3);
}

TEST_F(RigidScene, TheRoomsMotionIsFoundAgainThoughSomebodyNearCoversMostOfTheView) {
  // Somebody at 0.6 m in 53 % of the view, whom no mask knows; in the frame before the camera went with him.
  const cv::Rect person(0, 0, 85, 120);
  for (cv::Mat1f* depth_m : {&current.depth_m, &current.depth_low_m, &current.depth_high_m}) {
    (*depth_m)(person) = 0.6F;
  }
  cv::Mat2f mixed = flowOf(T_previous_current);
  for (const double step_m : {-0.06, 0.06}) {  // 0.9 m/s at 15 Hz
    const SE3 T_his = T_previous_current * SE3(Eigen::Translation3d(step_m, 0.0, 0.0));
    flowOf(T_his)(person).copyTo(mixed(person));
    Rng rng(3);
    for (cv::Vec2f& cell : mixed) {
      cell += cv::Vec2f(static_cast<float>(0.1 * rng.normal()), static_cast<float>(0.1 * rng.normal()));
    }
    const CameraMotion motion =
        estimateCameraMotion(pointsWithoutPreviousDepth(mixed, {}), grid, T_his, kStepS, config);
    ASSERT_TRUE(motion.valid);
    const SE3 error = motion.T_previous_current.inverse() * T_previous_current;
    EXPECT_LT(error.translation().norm(), 0.015) << step_m;  // a quarter of his step
    EXPECT_LT(rotationAngle(error), 0.006) << step_m;
  }
}

TEST_F(RigidScene, TheLastMotionHoldsTheCameraLessTheLongerTheStep) {
  // People cover the view, but for a corner; the hand has turned back meanwhile, by 4 cm in a tenth of a second.
  cv::Mat1f weight(grid.size(), 0.0F);
  weight(cv::Rect(120, 90, 40, 30)) = 0.3F;
  const auto points = pointsWithoutPreviousDepth(flow, weight);
  const SE3 predicted = T_previous_current * SE3(Eigen::Translation3d(0.04, 0.0, 0.0));
  const auto errorOver = [&](double step_s) {
    const SE3 T = estimateCameraMotion(points, grid, predicted, step_s, config).T_previous_current;
    return (T.inverse() * T_previous_current).translation().norm();
  };
  EXPECT_LT(errorOver(0.1), 0.005);
  EXPECT_GT(errorOver(kStepS), 2.0 * errorOver(0.1));
}

TEST_F(RigidScene, TooFewPointsAreNoMotion) {
  EXPECT_FALSE(estimateCameraMotion({}, grid, SE3::Identity(), kStepS, config).valid);
}

TEST_F(RigidScene, FlowOfTheCameraLeavesNoResidual) {
  CameraMotion motion;
  motion.T_previous_current = T_previous_current;
  motion.flow_sigma_px = 0.5;
  const RigidFlowResidual residual = computeRigidFlowResidual(previous, current, flow, motion, grid, config);
  int unknown = 0;
  for (int y = 0; y < residual.sigmas.rows; ++y) {
    for (int x = 0; x < residual.sigmas.cols; ++x) {
      if (std::isnan(residual.sigmas(y, x))) {
        ++unknown;  // came into view
      } else {
        EXPECT_LT(residual.amplitude_px(y, x), 0.05F) << x << ", " << y;
      }
    }
  }
  EXPECT_LT(unknown, residual.sigmas.size().area() / 20);
}

TEST_F(RigidScene, ResidualIsTheDistanceFromTheEpipolarPieceInPixels) {
  CameraMotion motion;  // at rest: the piece is a point
  motion.flow_sigma_px = 0.5;
  const cv::Mat2f measured(grid.size(), cv::Vec2f(0.75F, -1.0F));  // cells; eq. (1) gives 1.25 cells = 5 px
  const RigidFlowResidual residual = computeRigidFlowResidual(previous, current, measured, motion, grid, config);
  EXPECT_NEAR(residual.amplitude_px(60, 80), 5.0F, 1e-3F);
  EXPECT_NEAR(residual.sigmas(60, 80), 10.0F, 1e-2F);
}

TEST_F(RigidScene, HoleInDepthAllowsAnyDepthOfItsSurroundings) {
  CameraMotion motion;
  motion.T_previous_current.translation() = Eigen::Vector3d(0.05, 0.0, 0.0);
  motion.flow_sigma_px = 0.5;
  GridFrame holed = current;
  holed.depth_m = current.depth_m.clone();
  holed.depth_m = 0.0F;
  holed.depth_low_m = cv::Mat1f(grid.size(), 1.0F);
  holed.depth_high_m = cv::Mat1f(grid.size(), 4.0F);
  // 525 px * 0.05 m / z: 26.25 px at 1 m, 6.6 px at 4 m. 15 px along x is explained, 15 px along y is not.
  const auto along =
      computeRigidFlowResidual(previous, holed, cv::Mat2f(grid.size(), cv::Vec2f(-15.0F / 4, 0)), motion, grid, config);
  EXPECT_NEAR(along.amplitude_px(60, 80), 0.0F, 1e-2F);
  const auto across =
      computeRigidFlowResidual(previous, holed, cv::Mat2f(grid.size(), cv::Vec2f(0, -15.0F / 4)), motion, grid, config);
  EXPECT_GT(across.amplitude_px(60, 80), 10.0F);
}

TEST_F(RigidScene, BrightnessDecidesBetweenMeasuredAndRigidFlow) {
  // A stripe pattern that moves by 1 cell (2 gray pixels) to the right between the frames.
  for (int y = 0; y < current.gray.rows; ++y) {
    for (int x = 0; x < current.gray.cols; ++x) {
      previous.gray(y, x) = static_cast<uchar>(128 + 100 * std::sin(0.4 * x));
      current.gray(y, x) = static_cast<uchar>(128 + 100 * std::sin(0.4 * (x - 2)));
    }
  }
  for (GridFrame* frame : {&previous, &current}) {
    cv::resize(frame->gray, frame->cell_gray, grid.size(), 0, 0, cv::INTER_AREA);
  }
  CameraMotion rest;
  rest.flow_sigma_px = 0.5;
  const cv::Mat2f right(grid.size(), cv::Vec2f(1.0F, 0.0F)), left(grid.size(), cv::Vec2f(-1.0F, 0.0F));
  const auto found = computeRigidFlowResidual(previous, current, right, rest, grid, config);
  EXPECT_GT(cv::mean(compareBrightness(previous, current, right, found)(cv::Rect(20, 20, 120, 80)))[0], 0.8);
  const auto wrong = computeRigidFlowResidual(previous, previous, left, rest, grid, config);
  EXPECT_LT(cv::mean(compareBrightness(previous, previous, left, wrong)(cv::Rect(20, 20, 120, 80)))[0], -0.8);
}

PlacedFrame placed(const GridFrame& frame) { return {frame.stamp, frame.depth_m, frame.depth_m, SE3::Identity()}; }

DepthReference referenceOf(const GridFrame& frame) {
  return {placed(frame), frame.depth_low_m, cv::Mat1f(frame.depth_m.size(), 0.0F)};
}

GridFrame planeAt(double seconds, float depth_m) {
  GridFrame frame;
  frame.stamp = Stamp::fromSeconds(seconds);
  frame.depth_m = frame.depth_low_m = frame.depth_high_m = cv::Mat1f(120, 160, depth_m);
  return frame;
}

TEST_F(RigidScene, SurfaceThatApproachesIntoFreeSpaceIsVotedMoving) {
  const GridFrame before = planeAt(0.0, 2.0F);
  GridFrame now = planeAt(0.5, 2.0F);
  const cv::Rect walker(60, 30, 30, 60);
  now.depth_m = now.depth_m.clone();
  now.depth_m(walker) = 1.6F;  // came 0.4 m nearer along the optical axis
  const DepthVote vote = voteByDepth(placed(now), referenceOf(before), grid, config);
  EXPECT_FLOAT_EQ(vote.entered(60, 75), 1.0F);
  EXPECT_FLOAT_EQ(vote.stayed(60, 75), 0.0F);
  EXPECT_FLOAT_EQ(vote.entered(60, 20), 0.0F);
  EXPECT_FLOAT_EQ(vote.stayed(60, 20), 1.0F);
}

TEST_F(RigidScene, SurfaceThatWasHiddenIsNotVotedOn) {
  const DepthVote vote = voteByDepth(placed(planeAt(0.5, 2.0F)), referenceOf(planeAt(0.0, 1.0F)), grid, config);
  EXPECT_EQ(cv::countNonZero(vote.entered), 0);
  EXPECT_EQ(cv::countNonZero(vote.stayed), 0);
}

TEST_F(RigidScene, CameraThatApproachesAWallIsNoMover) {
  PlacedFrame now = placed(planeAt(0.5, 1.7F));
  now.T_odometry_camera.translation().z() = 0.3;
  const DepthVote vote = voteByDepth(now, referenceOf(planeAt(0.0, 2.0F)), grid, config);
  EXPECT_EQ(cv::countNonZero(vote.entered), 0);
  EXPECT_GT(cv::countNonZero(vote.stayed), 160 * 120 * 9 / 10);
}

TEST_F(RigidScene, NoDepthGivesNoVote) {
  const DepthVote vote = voteByDepth(placed(planeAt(0.5, 0.0F)), referenceOf(planeAt(0.0, 2.0F)), grid, config);
  EXPECT_EQ(cv::countNonZero(vote.entered), 0);
  EXPECT_EQ(cv::countNonZero(vote.stayed), 0);
}

TEST_F(RigidScene, HomographyIsRecoveredAmongMovers) {
  const cv::Matx33d H(1.01, 0.004, 1.5, -0.003, 0.995, -2.0, 1e-5, -2e-5, 1.0);
  const cv::Matx33d H_previous_current = H.inv();
  cv::Mat2f measured(grid.size());
  for (int y = 0; y < measured.rows; ++y) {
    for (int x = 0; x < measured.cols; ++x) {
      const cv::Vec3d before = H_previous_current * cv::Vec3d(x, y, 1.0);
      measured(y, x) = {static_cast<float>(x - before[0] / before[2]), static_cast<float>(y - before[1] / before[2])};
    }
  }
  measured(cv::Rect(0, 0, 60, 120)) = cv::Vec2f(6.0F, 3.0F);
  Rng rng(5);
  for (cv::Vec2f& f : measured)
    f += cv::Vec2f(static_cast<float>(0.03 * rng.normal()), static_cast<float>(0.03 * rng.normal()));
  const HomographyMotion motion = estimateHomography(current, measured, {}, grid, HomographyConfig());
  ASSERT_TRUE(motion.valid);
  for (const cv::Vec2d& corner : {cv::Vec2d(70, 5), cv::Vec2d(155, 5), cv::Vec2d(155, 115), cv::Vec2d(70, 115)}) {
    const cv::Vec3d expected = H * cv::Vec3d(corner[0], corner[1], 1.0);
    const cv::Vec3d found = motion.H_current_previous * cv::Vec3d(corner[0], corner[1], 1.0);
    EXPECT_NEAR(found[0] / found[2], expected[0] / expected[2], 0.1);
    EXPECT_NEAR(found[1] / found[2], expected[1] / expected[2], 0.1);
  }
}

TEST(SurfaceEvidenceTest, SharesAlongASurfaceAndStopsAtADepthEdge) {
  cv::Mat1f depth(40, 60, 3.0F), values(40, 60, 0.0F);
  depth(cv::Rect(0, 0, 30, 40)) = 1.0F;
  values(cv::Rect(0, 0, 30, 40)) = 1.0F;
  values(cv::Rect(10, 15, 3, 3)) = -5.0F;  // a gap in the evidence
  const cv::Mat1f shared = shareAlongSurfaces(values, {}, depth).log_odds;
  EXPECT_GT(shared(16, 11), 0.0F);
  EXPECT_GT(shared(20, 29), 0.8F);
  EXPECT_LT(shared(20, 30), 0.1F);
}

TEST(SurfaceEvidenceTest, MasksAreBroughtToTheEdgeInDepth) {
  cv::Mat1f depth(40, 60, 3.0F), mask(40, 60, 0.1F);
  depth(cv::Rect(0, 0, 30, 40)) = 1.0F;
  mask(cv::Rect(0, 0, 33, 40)) = 0.9F;  // three cells of the wall beside the person
  mask(cv::Rect(10, 10, 4, 4)) = std::numeric_limits<float>::quiet_NaN();
  const SurfaceEvidence evidence = shareAlongSurfaces({}, mask, depth);
  EXPECT_TRUE(evidence.log_odds.empty());
  EXPECT_GT(evidence.semantic(20, 29), 0.7F);
  EXPECT_LT(evidence.semantic(20, 32), 0.5F);
  EXPECT_GT(evidence.semantic(12, 12), 0.8F);  // unknown amid a person
}

TEST(SurfaceEvidenceTest, UnknownStaysUnknownWhereNothingNearbyIsKnown) {
  const cv::Mat1f depth(40, 60, 2.0F);
  cv::Mat1f mask(40, 60, std::numeric_limits<float>::quiet_NaN());
  mask(20, 5) = 0.9F;
  EXPECT_TRUE(std::isnan(shareAlongSurfaces({}, mask, depth).semantic(20, 50)));
}

TEST(MaskCleanupTest, RemovesSpecksFillsGapsAndKeepsTheRest) {
  MaskCleanupConfig config;
  config.open_px = 9;
  config.close_px = 21;
  config.min_area_px = 1200;
  cv::Mat1b mask = cv::Mat1b::zeros(120, 160);
  mask(cv::Rect(20, 20, 30, 50)) = 255;
  mask(cv::Rect(30, 40, 2, 2)) = 0;     // a gap
  mask(cv::Rect(100, 30, 1, 1)) = 255;  // a speck
  mask(cv::Rect(100, 80, 7, 7)) = 255;  // 784 px of the full image
  const cv::Mat1b cleaned = cleanMask(mask, 4.0F, config);
  EXPECT_EQ(cleaned(41, 31), 255);
  EXPECT_EQ(cleaned(30, 100), 0);
  EXPECT_EQ(cleaned(83, 103), 0);
  EXPECT_NEAR(cv::countNonZero(cleaned), 30 * 50, 20);
}

}  // namespace
}  // namespace semantic_vslam
