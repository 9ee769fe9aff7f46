// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/segmentation/network_input.h"

#include <gtest/gtest.h>

namespace semantic_vslam {
namespace {

ModelSidecar::Input description(TensorType type, TensorLayout layout, ChannelOrder channels, cv::Size size = {2, 1}) {
  ModelSidecar::Input input;
  input.size = size;
  input.type = type;
  input.layout = layout;
  input.channels = channels;
  return input;
}

/// Two pixels: blue 10 green 20 red 30, and blue 40 green 50 red 60.
cv::Mat3b twoPixels() { return (cv::Mat3b(1, 2) << cv::Vec3b(10, 20, 30), cv::Vec3b(40, 50, 60)); }

std::vector<float> floatsOf(NetworkInput& input) { return {input.floats(), input.floats() + input.elements()}; }

TEST(NetworkInput, NormalisesEachChannelInTheNetworksOrder) {
  auto d = description(TensorType::kFloat32, TensorLayout::kNchw, ChannelOrder::kRgb);
  d.scale = 0.1;
  d.mean = {1.0, 2.0, 0.0};
  d.std = {2.0, 1.0, 0.5};
  NetworkInput input(d);
  EXPECT_EQ(input.fill(twoPixels()), cv::Size(2, 1));
  EXPECT_EQ(input.shape(), (std::vector<std::int64_t>{1, 3, 1, 2}));
  // red (3 - 1) / 2, (6 - 1) / 2; green (2 - 2) / 1, (5 - 2) / 1; blue 1 / 0.5, 4 / 0.5
  const std::vector<float> expected{1.0F, 2.5F, 0.0F, 3.0F, 2.0F, 8.0F};
  const std::vector<float> got = floatsOf(input);
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(got[i], expected[i], 1e-5) << i;
}

TEST(NetworkInput, InterleavesForNhwc) {
  NetworkInput input(description(TensorType::kFloat32, TensorLayout::kNhwc, ChannelOrder::kBgr));
  input.fill(twoPixels());
  EXPECT_EQ(input.shape(), (std::vector<std::int64_t>{1, 1, 2, 3}));
  EXPECT_EQ(floatsOf(input), (std::vector<float>{10, 20, 30, 40, 50, 60}));
}

TEST(NetworkInput, GivesBytesInBothLayouts) {
  NetworkInput interleaved(description(TensorType::kUint8, TensorLayout::kNhwc, ChannelOrder::kRgb));
  interleaved.fill(twoPixels());
  EXPECT_EQ(std::vector<int>(interleaved.bytes(), interleaved.bytes() + 6), (std::vector<int>{30, 20, 10, 60, 50, 40}));
  NetworkInput planar(description(TensorType::kUint8, TensorLayout::kNchw, ChannelOrder::kRgb));
  planar.fill(twoPixels());
  EXPECT_EQ(std::vector<int>(planar.bytes(), planar.bytes() + 6), (std::vector<int>{30, 60, 20, 50, 10, 40}));
}

TEST(NetworkInput, LetterboxKeepsTheAspectRatioAndPads) {
  auto d = description(TensorType::kUint8, TensorLayout::kNhwc, ChannelOrder::kBgr, {8, 8});
  d.resize = ResizeMode::kLetterbox;
  d.pad_value = 9;
  NetworkInput input(d);
  EXPECT_EQ(input.fill(cv::Mat3b(10, 20, cv::Vec3b(1, 2, 3))), cv::Size(8, 4));
  EXPECT_EQ(input.bytes()[3 * (8 * 3 + 7)], 1);  // last row and column of the image
  EXPECT_EQ(input.bytes()[3 * (8 * 4)], 9);      // first row of the padding
  // A tall image after a wide one leaves nothing of it in the padding.
  EXPECT_EQ(input.fill(cv::Mat3b(20, 10, cv::Vec3b(1, 2, 3))), cv::Size(4, 8));
  EXPECT_EQ(input.bytes()[3 * 4], 9);
}

TEST(NetworkInput, StretchFillsTheInput) {
  NetworkInput input(description(TensorType::kUint8, TensorLayout::kNhwc, ChannelOrder::kBgr, {8, 8}));
  EXPECT_EQ(input.fill(cv::Mat3b(10, 20, cv::Vec3b(1, 2, 3))), cv::Size(8, 8));
  EXPECT_EQ(input.bytes()[3 * 63 + 2], 3);
}

}  // namespace
}  // namespace semantic_vslam
