// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/motion/dense_flow.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "core/common/rng.h"
#include "core/motion/flow_colour.h"

namespace semantic_vslam {
namespace {

cv::Mat1b texturedImage(cv::Size size) {
  Rng rng(3);
  cv::Mat1b image(size);
  for (uchar& value : image) value = static_cast<uchar>(rng.below(256));
  cv::GaussianBlur(image, image, {0, 0}, 2.0);
  cv::normalize(image, image, 0, 255, cv::NORM_MINMAX);
  return image;
}

TEST(DenseFlowTest, FindsAKnownShiftWithItsSign) {
  const cv::Mat1b large = texturedImage({400, 300});
  const cv::Mat1b previous = large(cv::Rect(40, 30, 320, 240)).clone();
  const cv::Mat1b current = large(cv::Rect(35, 33, 320, 240)).clone();  // content moves 5 px right and 3 px up
  for (const char* preset : {"ultrafast", "fast", "medium"}) {
    const cv::Mat2f flow = DenseFlow(preset).compute(previous, current);
    ASSERT_EQ(flow.size(), current.size());
    const cv::Scalar mean = cv::mean(flow(cv::Rect(30, 30, 260, 180)));
    EXPECT_NEAR(mean[0], 5.0, 0.2) << preset;
    EXPECT_NEAR(mean[1], -3.0, 0.2) << preset;
  }
}

TEST(DenseFlowTest, DoesNotDependOnWhatWasComputedBefore) {
  const cv::Mat1b a = texturedImage({160, 120});
  cv::Mat1b b;
  cv::flip(a, b, 1);
  DenseFlow used("ultrafast"), fresh("ultrafast");
  used.compute(a, b);
  EXPECT_EQ(cv::norm(used.compute(b, b), fresh.compute(b, b), cv::NORM_INF), 0.0);
}

TEST(DenseFlowTest, AmplitudeIsEquationOne) {
  const cv::Mat2f flow = (cv::Mat2f(1, 3) << cv::Vec2f(3, 4), cv::Vec2f(0, 0), cv::Vec2f(-5, 12));
  const cv::Mat1f amplitude = flowAmplitude(flow);
  EXPECT_FLOAT_EQ(amplitude(0, 0), 5.0F);
  EXPECT_FLOAT_EQ(amplitude(0, 1), 0.0F);
  EXPECT_FLOAT_EQ(amplitude(0, 2), 13.0F);
}

TEST(FlowPictureTest, RestIsWhiteDirectionIsHueAndUnknownIsBlack) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const cv::Mat2f flow = (cv::Mat2f(1, 4) << cv::Vec2f(0, 0), cv::Vec2f(10, 0), cv::Vec2f(-10, 0), cv::Vec2f(nan, nan));
  const cv::Mat3b picture = flowPicture(flow, 10.0);
  EXPECT_EQ(picture(0, 0), cv::Vec3b(255, 255, 255));
  EXPECT_GT(picture(0, 1)[2], picture(0, 1)[0]);  // to the right: red
  EXPECT_LT(picture(0, 2)[2], picture(0, 2)[0]);  // to the left: blue-green
  EXPECT_EQ(picture(0, 3), cv::Vec3b(0, 0, 0));
}

TEST(FlowPictureTest, AmplitudeIsSaturation) {
  const cv::Mat2f flow = (cv::Mat2f(1, 2) << cv::Vec2f(2, 0), cv::Vec2f(8, 0));
  const cv::Mat3b picture = flowPicture(flow, 10.0);
  EXPECT_GT(picture(0, 0)[0], picture(0, 1)[0]);
}

}  // namespace
}  // namespace semantic_vslam
