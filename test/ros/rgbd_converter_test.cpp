// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/rgbd_converter.h"

#include <gtest/gtest.h>

#include <boost/make_shared.hpp>

namespace semantic_vslam {
namespace {

sensor_msgs::ImagePtr image(const char* encoding, std::uint32_t pixel_bytes) {
  auto message = boost::make_shared<sensor_msgs::Image>();
  message->width = 8;
  message->height = 6;
  message->encoding = encoding;
  message->step = message->width * pixel_bytes;
  message->data.resize(message->step * message->height);
  return message;
}

RgbdMessages pair(std::uint64_t index, const char* depth_encoding) {
  auto info = boost::make_shared<sensor_msgs::CameraInfo>();
  info->width = 8;
  info->height = 6;
  info->K = {10, 0, 4, 0, 10, 3, 0, 0, 1};
  info->P = {10, 0, 4, 0, 0, 10, 3, 0, 0, 0, 1, 0};
  return {index, image("bgr8", 3), image(depth_encoding, 2), info};
}

TEST(RgbdConverter, FramesKeepTheNumberOfTheirPairAlsoWhenPairsBetweenAreLost) {
  RgbdConverter converter{RgbdInputConfig()};
  ASSERT_TRUE(converter.convert(pair(3, "16UC1")));
  EXPECT_FALSE(converter.convert(pair(4, "mono16")));
  const auto frame = converter.convert(pair(7, "16UC1"));
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->index, 7U);
  EXPECT_EQ(converter.refused(), 1U);
}

}  // namespace
}  // namespace semantic_vslam
