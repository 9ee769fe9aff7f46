// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "eval/mask_score.h"

#include <gtest/gtest.h>

namespace semantic_vslam {
namespace {

TEST(MaskScore, CountsPixelsOfAllFramesTogether) {
  MaskScore score;
  // both 2, only estimate 1, only truth 1
  score.add((cv::Mat1b(1, 5) << 255, 255, 255, 0, 0), (cv::Mat1b(1, 5) << 255, 255, 0, 255, 0));
  // both 1, only estimate 0, only truth 3
  score.add((cv::Mat1b(1, 5) << 255, 0, 0, 0, 0), (cv::Mat1b(1, 5) << 255, 255, 255, 255, 0));
  EXPECT_EQ(score.frames(), 2U);
  EXPECT_DOUBLE_EQ(score.iou(), 3.0 / 8.0);
  EXPECT_DOUBLE_EQ(score.precision(), 3.0 / 4.0);
  EXPECT_DOUBLE_EQ(score.recall(), 3.0 / 7.0);
}

TEST(MaskScore, APixelIsSetFrom128On) {
  MaskScore score;
  score.add((cv::Mat1b(1, 4) << 127, 128, 200, 1), (cv::Mat1b(1, 4) << 255, 255, 128, 127));
  EXPECT_DOUBLE_EQ(score.precision(), 1.0);
  EXPECT_DOUBLE_EQ(score.recall(), 2.0 / 3.0);
}

TEST(MaskScore, NothingThereAndNothingFoundIsRight) {
  MaskScore score;
  score.add(cv::Mat1b::zeros(2, 2), cv::Mat1b::zeros(2, 2));
  EXPECT_DOUBLE_EQ(score.iou(), 1.0);
  EXPECT_DOUBLE_EQ(score.precision(), 1.0);
  EXPECT_DOUBLE_EQ(score.recall(), 1.0);
  score.add(cv::Mat1b(2, 2, std::uint8_t{255}), cv::Mat1b::zeros(2, 2));
  EXPECT_DOUBLE_EQ(score.iou(), 0.0);
  EXPECT_DOUBLE_EQ(score.precision(), 0.0);
}

}  // namespace
}  // namespace semantic_vslam
