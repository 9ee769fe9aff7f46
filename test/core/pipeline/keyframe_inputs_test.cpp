// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/keyframe_inputs.h"

#include <gtest/gtest.h>

#include "core/support/fixtures.h"

namespace semantic_vslam {
namespace {

Stamp at(double seconds) { return Stamp::fromSeconds(seconds); }

/// Brings all that comes of a frame, but for its labels.
void bring(KeyframeInputs& inputs, Stamp stamp) {
  inputs.put(PendingFrame{stamp, 0, [] { return std::optional<RgbdFrame>(frameOf(cv::Mat1f(96, 128, 2.0F))); }});
  inputs.put(stamp, MotionResult());
  inputs.put(FramePlace{stamp, 1, KeyframeId(7), SE3::Identity()});
}

constexpr Running kMotion{true, false}, kNetwork{true, true};

TEST(KeyframeInputs, AFrameIsLookedAtWhereNoKeyframeCame) {
  KeyframeInputs inputs(KeyframeInputsConfig(), 30);
  bring(inputs, at(1.0));
  EXPECT_FALSE(inputs.look(at(1.0), kMotion)) << "there is no keyframe yet";
  inputs.name({KeyframeId(7), 1, at(1.0)});
  for (const double seconds : {1.2, 1.4}) {
    bring(inputs, at(seconds));
    EXPECT_FALSE(inputs.look(at(seconds), kMotion)) << seconds;
  }
  bring(inputs, at(1.5));
  const auto look = inputs.look(at(1.5), kMotion);
  ASSERT_TRUE(look);
  EXPECT_EQ(look->keyframe.id, KeyframeId(7));
  EXPECT_EQ(look->keyframe.stamp, at(1.5));
  EXPECT_TRUE(look->T_keyframe_camera);
  EXPECT_FALSE(inputs.look(at(1.5), kMotion)) << "once";
  const auto gathered = inputs.gather(*look, kMotion);
  ASSERT_TRUE(gathered);
  EXPECT_TRUE(decode(*gathered)->T_keyframe_camera);
}

TEST(KeyframeInputs, WhereANetworkRunsOnlyAFrameWithLabelsIsLookedAt) {
  KeyframeInputs inputs(KeyframeInputsConfig(), 30);
  inputs.name({KeyframeId(7), 1, at(1.0)});
  bring(inputs, at(1.6));
  EXPECT_FALSE(inputs.look(at(1.6), kNetwork));
  bring(inputs, at(1.7));
  inputs.put(FrameLabels{at(1.6), cv::Mat1b(96, 128, std::uint8_t{0})});
  EXPECT_TRUE(inputs.look(at(1.6), kNetwork));
}

TEST(KeyframeInputs, WhatIsOlderThanTheNewestKeyframeIsNotLookedAt) {
  KeyframeInputs inputs(KeyframeInputsConfig(), 30);
  bring(inputs, at(1.0));
  inputs.name({KeyframeId(7), 1, at(2.0)});
  EXPECT_FALSE(inputs.look(at(1.0), kMotion));
}

TEST(KeyframeInputs, WhereMotionCannotBeToldOnlyWhatHasLabelsIsMapped) {
  MotionResult untold;
  untold.told = false;
  for (const bool labelled : {false, true}) {
    KeyframeInputs inputs(KeyframeInputsConfig(), 30);
    for (const double seconds : {1.0, 2.0}) {
      bring(inputs, at(seconds));
      inputs.put(at(seconds), untold);
      if (labelled) inputs.put(FrameLabels{at(seconds), cv::Mat1b(96, 128, std::uint8_t{0})});
    }
    const auto named = inputs.name({KeyframeId(7), 1, at(1.0)});
    EXPECT_EQ(inputs.gather(named, kMotion).has_value(), labelled);
    EXPECT_EQ(inputs.counts().untold, labelled ? 0U : 1U);
    EXPECT_EQ(inputs.look(at(2.0), kMotion).has_value(), labelled) << "of frames between keyframes too";
  }
}

TEST(KeyframeInputs, AfterAClockThatIsSetBackFramesAreLookedAtAgain) {
  KeyframeInputs inputs(KeyframeInputsConfig(), 30);
  bring(inputs, at(100.0));
  inputs.name({KeyframeId(7), 1, at(100.0)});
  for (const double seconds : {50.0, 50.4}) {
    bring(inputs, at(seconds));
    EXPECT_FALSE(inputs.look(at(seconds), kMotion)) << seconds;
  }
  bring(inputs, at(50.5));
  EXPECT_TRUE(inputs.look(at(50.5), kMotion));
}

}  // namespace
}  // namespace semantic_vslam
