// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
// How tracking begins where people are.
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "core/pipeline/tracking_stage.h"
#include "core/support/walking_frames.h"
#include "eval/mask_score.h"
#include "semantic_vslam/core/pipeline/pipeline.h"

namespace semantic_vslam {
namespace {

TEST(Start, OnlyK1IsSegmentedBeforeTrackingAndItsPeopleAreCarriedOn) {
  std::vector<int> asked;
  SystemConfig config = sparse();
  config.motion.model = "none";  // nothing but the labels tells what is dynamic
  Pipeline system(config, std::make_unique<NotingNetwork>(asked));
  ASSERT_GT(cv::countNonZero(frames()[1].person_mask), 0.05 * 320 * 240) << "somebody is there";
  const StepResult k1 = system.step(frames()[0].frame);
  EXPECT_EQ(k1.tracking.state, TrackingState::kInitialising);
  ASSERT_EQ(asked, std::vector<int>{0});
  const StepResult k2 = system.step(frames()[1].frame);
  EXPECT_EQ(asked.size(), 1U) << "k2 waits for no network";
  MaskScore carried;
  carried.add(k2.motion.dynamic, frames()[1].person_mask);
  EXPECT_GT(carried.iou(), 0.8);
  EXPECT_TRUE(k2.posed());
}

TEST(Start, WithoutLabelsForTooLongMotionAloneMustDo) {
  TrackingWaits waits;
  waits.init_wait_s = 0.5;
  TrackingStage stage(SparseSlamConfig(), waits, RemovalConfig());
  int waited = 0;
  for (const SyntheticFrame& synthetic : frames()) {
    if (stage.wantsLabels({synthetic.frame, {}, {}, true})) ++waited;
  }
  EXPECT_EQ(waited, 15) << "half a second";
  EXPECT_FALSE(stage.wantsLabels({frames().back().frame, {}, {}, false})) << "no network, no labels";
}

TEST(Start, WhereK2DoesNotFitLabelsAreRenewedInTime) {
  std::vector<int> asked;
  SystemConfig config = sparse();
  config.slam.tracking.initializer.min_inliers = 5000;  // no pair ever fits
  Pipeline system(config, std::make_unique<NotingNetwork>(asked));
  for (const SyntheticFrame& synthetic : frames()) system.step(synthetic.frame);
  EXPECT_EQ(asked, (std::vector<int>{0, 16})) << "every half second, not every frame";
}

TEST(Start, AFrameWithoutLabelsMayBecomeK2ButNeverK1) {
  std::vector<int> asked;
  SystemConfig config = sparse();
  config.label_delay_s = 10.0;                          // labels are never carried on in time
  config.slam.tracking.initializer.min_inliers = 5000;  // no pair ever fits
  Pipeline system(config, std::make_unique<NotingNetwork>(asked));
  for (int i = 0; i < 6; ++i) system.step(frames()[i].frame);
  EXPECT_EQ(asked, (std::vector<int>{0, 2, 4})) << "where k2 does not fit the next frame is segmented as k1";
}

}  // namespace
}  // namespace semantic_vslam
