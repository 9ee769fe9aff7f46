// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/camera/bilinear.h"

#include <gtest/gtest.h>

namespace semantic_vslam {
namespace {

TEST(SampleBilinear, IsExactOnAPlaneUpToTheLastPixel) {
  cv::Mat1f image(4, 5);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) image(y, x) = static_cast<float>(2 * x - 3 * y);
  }
  EXPECT_FLOAT_EQ(sampleBilinear(image, 1.25F, 2.5F), 2.5F - 7.5F);
  EXPECT_FLOAT_EQ(sampleBilinear(image, 4.0F, 3.0F), 8.0F - 9.0F);
}

TEST(SampleBilinear, BlendsEveryChannel) {
  const cv::Mat2f image = (cv::Mat2f(2, 2) << cv::Vec2f(0, 8), cv::Vec2f(4, 8), cv::Vec2f(0, 0), cv::Vec2f(4, 0));
  EXPECT_EQ(sampleBilinear(image, 0.25F, 0.5F), cv::Vec2f(1, 4));
}

}  // namespace
}  // namespace semantic_vslam
