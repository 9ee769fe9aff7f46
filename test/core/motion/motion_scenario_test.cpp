// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "core/motion/motion_detector.h"
#include "core/support/quarter_vga.h"
#include "eval/mask_score.h"
#include "eval/synthetic_room.h"

namespace semantic_vslam {
namespace {

/// Recall counts what moves in that frame; what is found on a person who stands still is no false alarm.
struct Score {
  MaskScore against_moving, against_people_and_moving;
  double share = 0.0, worst_share = 0.0;  // of the image, called dynamic
  int frames = 0, rigid = 0;
  int mostly_covered = 0;  // frames of which movers truly fill 60 % or more

  double recall() const { return against_moving.recall(); }
  double precision() const { return against_people_and_moving.precision(); }
};

/// Runs part of a scenario. Frames up to settle_frames are fed but not scored. @param step_s  0: as in the scenario
Score runScenario(const std::string& name, double from_s, double to_s, int settle_frames, const MotionConfig& config,
                  double step_s = 0.0) {
  const SyntheticRoom room(makeScenario(name, 3), quarterVga());
  MotionDetector detector(config);
  Score score;
  int index = 0;
  for (double t = from_s; t<to_s; t += step_s> 0.0 ? step_s : 1.0 / room.scenario().fps, ++index) {
    const SyntheticFrame truth = room.render(t);
    const MotionResult result = detector.detect(truth.frame);
    if (index < settle_frames) continue;
    score.against_moving.add(result.dynamic, truth.moving_mask);
    score.against_people_and_moving.add(result.dynamic, truth.person_mask | truth.moving_mask);
    score.share += result.dynamic_share;
    score.worst_share = std::max(score.worst_share, result.dynamic_share);
    const cv::Mat1b movers = truth.person_mask | truth.moving_mask;
    score.mostly_covered += cv::countNonZero(movers) >= 0.6 * static_cast<double>(movers.total()) ? 1 : 0;
    score.rigid += result.model == MotionModel::kRigidFlow ? 1 : 0;
    ++score.frames;
  }
  score.share /= score.frames;
  return score;
}

Score expectFound(const std::string& name, double from_s, double to_s, double least_recall, double least_precision) {
  const Score score = runScenario(name, from_s, to_s, 10, {});
  EXPECT_GE(score.recall(), least_recall) << name;
  EXPECT_GE(score.precision(), least_precision) << name;
  EXPECT_EQ(score.rigid, score.frames) << name;
  return score;
}

TEST(MotionScenarioTest, AtFiveFramesASecondWalkersAreFoundByADearerFlow) {
  MotionConfig quick;
  quick.flow.slow_preset = quick.flow.preset;
  for (const char* name : {"walking", "planar_wall"}) {
    const Score score = runScenario(name, 1.0, 7.0, 3, {}, 0.2), by_quick = runScenario(name, 1.0, 7.0, 3, quick, 0.2);
    EXPECT_GE(score.recall(), 0.75) << name;
    EXPECT_GE(score.precision(), 0.8) << name;
    EXPECT_GT(score.recall(), by_quick.recall()) << name;
  }
  const Score score = runScenario("static", 1.0, 7.0, 3, {}, 0.2);
  EXPECT_LT(score.share, 0.01) << "nothing moves";
}

TEST(MotionScenarioTest, EmptyRoomIsStatic) {
  const Score score = runScenario("static", 2.0, 4.0, 10, {});
  EXPECT_LT(score.share, 0.01);
  EXPECT_LT(score.worst_share, 0.05);
  EXPECT_EQ(score.rigid, score.frames);
}

TEST(MotionScenarioTest, WalkersAreFound) { expectFound("walking", 2.0, 4.0, 0.8, 0.8); }

TEST(MotionScenarioTest, WalkersAreFoundByARotatingCamera) { expectFound("rotation", 2.0, 5.0, 0.7, 0.7); }

TEST(MotionScenarioTest, WalkerAlongAPlanarWallIsFound) { expectFound("planar_wall", 2.0, 5.0, 0.8, 0.8); }

TEST(MotionScenarioTest, NearMoverOverMostOfTheImageIsFound) {
  const Score score = expectFound("near_mover", 3.6, 5.0, 0.8, 0.8);
  EXPECT_GE(score.mostly_covered, 5) << "frames in which the mover fills 60 % of the image or more";
}

TEST(MotionScenarioTest, PushedChairIsFoundWithItsPusher) { expectFound("pushed_chair", 2.0, 4.5, 0.8, 0.7); }

TEST(MotionScenarioTest, CarriedBoxIsFoundWithItsCarrier) { expectFound("carried_box", 2.0, 4.0, 0.8, 0.7); }

TEST(MotionScenarioTest, WalkerAlongTheOpticalAxisIsFound) { expectFound("along_axis", 2.0, 4.0, 0.55, 0.75); }

TEST(MotionScenarioTest, PersonWhoWalksOnAfterAPauseIsFound) { expectFound("pause", 5.3, 7.0, 0.7, 0.75); }

}  // namespace
}  // namespace semantic_vslam
