// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/io/tum_writer.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <opencv2/imgcodecs.hpp>

#include "core/io/tum_sequence.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

namespace fs = std::filesystem;

CameraIntrinsics tinyCamera() {
  CameraIntrinsics k;
  k.width = 32;
  k.height = 24;
  k.fx = k.fy = 26.25;
  k.cx = 15.5;
  k.cy = 11.5;
  k.distortion = {0.1, -0.2, 0.001, -0.002, 0.05};
  return k;
}

TumFrame makeFrame(int index) {
  TumFrame frame;
  frame.stamp = Stamp::fromSeconds(1000.0 + index / 30.0);
  frame.bgr = cv::Mat3b(24, 32, cv::Vec3b(10, 20, static_cast<std::uint8_t>(30 + index)));
  frame.depth_m = cv::Mat1f(24, 32, 1.5F + 0.1F * static_cast<float>(index));
  frame.depth_m(0, 0) = 0.0F;
  frame.depth_m(0, 1) = 14.0F;  // more than 16 bit hold
  frame.mask = cv::Mat1b(24, 32, static_cast<std::uint8_t>(index == 1 ? 255 : 0));
  frame.labels = cv::Mat1b(24, 32, static_cast<std::uint8_t>(index));
  SE3 pose = SE3::Identity();
  pose.translation().x() = index;
  frame.T_world_camera = pose;
  return frame;
}

class TumWriterTest : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(root_);
    fs::create_directories(root_);
  }
  void TearDown() override { fs::remove_all(root_); }
  const fs::path root_ = fs::temp_directory_path() / ("tum_writer_test-" + std::to_string(getpid()));
};

TEST_F(TumWriterTest, WritesWhatTumSequenceReadsBack) {
  const std::string folder = (root_ / "sequence").string();
  TumWriter writer(folder + "/", tinyCamera(), TumWriter::ColorFormat::kPng);
  for (int i = 0; i < 3; ++i) writer.write(makeFrame(i));
  EXPECT_FALSE(fs::exists(folder));
  writer.finish();

  const CameraIntrinsics camera = loadCameraFile(folder + "/camera.yaml");
  EXPECT_EQ(camera.distortion, tinyCamera().distortion);
  EXPECT_DOUBLE_EQ(camera.fx, 26.25);
  TumSequence sequence(folder, std::make_shared<CameraModel>(camera));
  ASSERT_EQ(sequence.size(), 3U);
  ASSERT_EQ(sequence.groundTruth().size(), 3U);
  for (int i = 0; i < 3; ++i) {
    const auto frame = sequence.next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->stamp, makeFrame(i).stamp);
    EXPECT_EQ(frame->bgr(5, 5), makeFrame(i).bgr(5, 5));
    EXPECT_NEAR(frame->depth_m(5, 5), 1.5 + 0.1 * i, 1e-4);
    EXPECT_EQ(frame->depth_m(0, 0), 0.0F);
    EXPECT_EQ(frame->depth_m(0, 1), 0.0F);
    EXPECT_EQ(sequence.groundTruthMask()(5, 5), i == 1 ? 255 : 0);
    EXPECT_DOUBLE_EQ(sequence.groundTruth()[i].T_world_camera.translation().x(), i);
    const std::string labels = folder + "/labels/" + formatStamp(frame->stamp) + ".png";
    EXPECT_EQ(cv::imread(labels, cv::IMREAD_GRAYSCALE).at<std::uint8_t>(3, 3), i);
  }
}

TEST_F(TumWriterTest, LeavesNothingBehindWhenItIsNotFinished) {
  {
    TumWriter writer((root_ / "half").string(), tinyCamera(), TumWriter::ColorFormat::kJpeg95);
    writer.write(makeFrame(0));
  }
  EXPECT_TRUE(fs::is_empty(root_));
}

TEST_F(TumWriterTest, NeverOverwrites) {
  fs::create_directories(root_ / "there");
  try {
    TumWriter writer((root_ / "there").string(), tinyCamera(), TumWriter::ColorFormat::kPng);
    FAIL();
  } catch (const FileError& error) {
    EXPECT_NE(std::string(error.what()).find("exists already"), std::string::npos);
  }
}

}  // namespace
}  // namespace semantic_vslam
