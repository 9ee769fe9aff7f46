// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/motion/mask_picture.h"

#include <gtest/gtest.h>

namespace semantic_vslam {
namespace {

TEST(MaskPicture, WhatMovesIsRedderTheSurerItIs) {
  const cv::Mat3b bgr(1, 3, cv::Vec3b(100, 100, 100));
  const cv::Mat1b dynamic = (cv::Mat1b(1, 3) << 127, 160, 255);
  const cv::Mat3b picture = maskPicture(bgr, dynamic);
  EXPECT_EQ(picture(0, 0), bgr(0, 0)) << "stands still";
  EXPECT_GT(picture(0, 1)[2], bgr(0, 1)[2]);
  EXPECT_GT(picture(0, 2)[2], picture(0, 1)[2]);
  EXPECT_LT(picture(0, 2)[0], bgr(0, 2)[0]);
  EXPECT_GT(picture(0, 2)[0], 0) << "the person is still to be seen";
}

}  // namespace
}  // namespace semantic_vslam
