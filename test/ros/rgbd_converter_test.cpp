// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/rgbd_converter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/make_shared.hpp>
#include <boost/weak_ptr.hpp>
#include <cmath>
#include <thread>
#include <vector>

namespace semantic_vslam {
namespace {

sensor_msgs::ImagePtr image(const char* encoding, std::uint32_t pixel_bytes) {
  auto message = boost::make_shared<sensor_msgs::Image>();
  message->width = 64;
  message->height = 48;
  message->encoding = encoding;
  message->step = message->width * pixel_bytes;
  message->data.resize(message->step * message->height);
  return message;
}

sensor_msgs::CameraInfoPtr cameraInfo() {
  auto info = boost::make_shared<sensor_msgs::CameraInfo>();
  info->width = 64;
  info->height = 48;
  info->K = {50, 0, 32, 0, 50, 24, 0, 0, 1};
  info->P = {50, 0, 32, 0, 0, 50, 24, 0, 0, 0, 1, 0};
  return info;
}

RgbdMessages pair(std::uint64_t index, const char* depth_encoding = "32FC1", const char* colour_encoding = "bgr8") {
  return {index, image(colour_encoding, 3), image(depth_encoding, 4), cameraInfo()};
}

std::shared_ptr<RgbdConverter> converter() { return std::make_shared<RgbdConverter>("", true); }

TEST(RgbdConverter, FramesKeepTheNumberOfTheirPairAlsoWhenPairsBetweenAreLost) {
  const auto input = converter();
  ASSERT_TRUE(input->pending(pair(3)).decode());
  EXPECT_FALSE(input->pending(pair(4, "mono8")).decode());
  const auto frame = input->pending(pair(7)).decode();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->index, 7U);
  EXPECT_EQ(input->refusals().count(), 1U);
  EXPECT_NE(input->refusals().last().find("mono8"), std::string::npos);
}

/// A pair that nothing is wrong with: 2 m all over.
RgbdMessages goodPair() {
  RgbdMessages messages = pair(0);
  auto rgb = boost::make_shared<sensor_msgs::Image>(*messages.rgb),
       depth = boost::make_shared<sensor_msgs::Image>(*messages.depth);
  rgb->header.frame_id = depth->header.frame_id = "camera";
  auto* z_m = reinterpret_cast<float*>(depth->data.data());
  std::fill_n(z_m, depth->data.size() / sizeof(float), 2.0F);
  messages.rgb = rgb;
  messages.depth = depth;
  return messages;
}

/// @return what is doubted after so many such pairs; all of them are taken
template <class Change>
std::string doubtOf(Change change, int pairs = 1) {
  const auto input = converter();
  for (int i = 0; i < pairs; ++i) {
    RgbdMessages messages = goodPair();
    auto rgb = boost::make_shared<sensor_msgs::Image>(*messages.rgb),
         depth = boost::make_shared<sensor_msgs::Image>(*messages.depth);
    change(*rgb, *depth);
    messages.rgb = rgb;
    messages.depth = depth;
    EXPECT_TRUE(input->pending(messages).decode());
  }
  EXPECT_EQ(input->refusals().count(), 0U);
  return input->doubts().last();
}

void fill(sensor_msgs::Image& depth, float z_m) {
  std::fill_n(reinterpret_cast<float*>(depth.data.data()), depth.data.size() / sizeof(float), z_m);
}

TEST(RgbdConverter, SaysWhatCanHardlyBeMeant) {
  using sensor_msgs::Image;
  EXPECT_EQ(doubtOf([](Image&, Image&) {}, 20), "");
  EXPECT_NE(doubtOf([](Image&, Image& depth) { depth.header.frame_id = "depth"; }).find("registered"),
            std::string::npos);
  EXPECT_NE(doubtOf([](Image& rgb, Image&) { rgb.header.frame_id = ""; }).find("frame_id is empty"), std::string::npos);
  const auto none = [](Image&, Image& depth) { fill(depth, std::nanf("")); };
  EXPECT_EQ(doubtOf(none, 9), "") << "somebody passes";
  EXPECT_NE(doubtOf(none, 10).find("depth camera covered"), std::string::npos);
  EXPECT_NE(doubtOf([](Image&, Image& depth) { fill(depth, 2000.0F); }, 10).find("32FC1 in millimetres"),
            std::string::npos);
  EXPECT_NE(doubtOf([](Image&, Image& depth) {
              depth.encoding = "16UC1";
              depth.step /= 2;
              depth.data.resize(depth.step * depth.height);
              std::fill_n(reinterpret_cast<std::uint16_t*>(depth.data.data()), 64 * 48, std::uint16_t{13000});
            }).find("1/5000"),
            std::string::npos);
}

TEST(RgbdConverter, FollowsARegionOfTheSensorThatMoves) {
  const auto input = converter();
  RgbdMessages messages = goodPair();
  EXPECT_EQ(input->pending(messages).decode()->camera->cx(), 32.0);
  messages = goodPair();
  auto info = boost::make_shared<sensor_msgs::CameraInfo>(*messages.info);
  info->roi.width = 64;
  info->roi.height = 48;
  info->roi.x_offset = 10;
  messages.info = info;
  EXPECT_EQ(input->pending(messages).decode()->camera->cx(), 22.0);
}

TEST(RgbdConverter, WhatNeedsNoConversionReachesTheStageInTheMemoryOfTheDriver) {
  RgbdMessages messages = pair(0);
  const auto* colour = messages.rgb->data.data();
  const auto* depth = messages.depth->data.data();
  boost::weak_ptr<const sensor_msgs::Image> message = messages.rgb;
  std::optional<RgbdFrame> frame = converter()->pending(messages).decode();
  messages = RgbdMessages();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->bgr.data, colour);
  EXPECT_EQ(reinterpret_cast<const std::uint8_t*>(frame->depth_m.data), depth);
  const cv::Mat kept = frame->bgr;
  frame.reset();
  EXPECT_FALSE(message.expired()) << "an image that is still used must keep its message";
  const_cast<cv::Mat&>(kept).release();
  EXPECT_TRUE(message.expired());
}

TEST(RgbdConverter, ConvertsAPairOnceForAllNodeletsOfAManager) {
  constexpr int kNodelets = 4, kPairs = 20;
  const auto input = RgbdConverter::of("rgb depth", "", true);
  EXPECT_EQ(RgbdConverter::of("rgb depth", "", true), input);
  EXPECT_NE(RgbdConverter::of("other", "", true), input) << "another camera has a converter of its own";
  std::vector<std::vector<PendingFrame>> kept(kNodelets);  // each nodelet's pairs, that come in at different times
  for (int i = 0; i < kPairs; ++i) {
    const RgbdMessages messages = pair(i, "32FC1", "rgb8");
    for (auto& frames : kept) frames.push_back(input->pending(messages));
  }
  std::vector<std::vector<const void*>> images(kNodelets);
  std::vector<std::thread> stages;
  for (int n = 0; n < kNodelets; ++n) {
    stages.emplace_back([&, n] {
      for (const PendingFrame& frame : kept[n]) images[n].push_back(frame.decode()->bgr.data);
    });
  }
  for (std::thread& stage : stages) stage.join();
  for (const auto& seen : images) EXPECT_EQ(seen, images.front());
  EXPECT_EQ(input->converted(), static_cast<std::size_t>(kPairs));
}

TEST(RgbdConverter, NothingIsKeptThatNoStageKeeps) {
  const auto input = converter();
  RgbdMessages messages = pair(0);
  const boost::weak_ptr<const sensor_msgs::Image> message = messages.rgb;
  PendingFrame pending = input->pending(messages);
  messages = RgbdMessages();
  EXPECT_FALSE(message.expired());
  pending = PendingFrame();
  EXPECT_TRUE(message.expired());
}

}  // namespace
}  // namespace semantic_vslam
