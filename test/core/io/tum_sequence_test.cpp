// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/io/tum_sequence.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "core/io/image_file.h"
#include "semantic_vslam/core/common/error.h"
#include "semantic_vslam/core/common/log.h"

namespace semantic_vslam {
namespace {

namespace fs = std::filesystem;

const cv::Size kSize(64, 48);

std::shared_ptr<const CameraModel> smallCamera(int width = kSize.width) {
  CameraIntrinsics k;
  k.width = width;
  k.height = kSize.height;
  k.fx = k.fy = 50.0;
  k.cx = 31.5;
  k.cy = 23.5;
  return std::make_shared<CameraModel>(k);
}

/// A folder with three frames at 1.0, 1.1 and 1.2 s; depth is 5 ms late and 1, 2 and 3 m.
class TumFolder : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / "tum_folder";
    fs::remove_all(folder_);
    for (const char* name : {"rgb", "depth", "mask"}) fs::create_directories(folder_ / name);
    std::string rgb_list = "# timestamp filename\n", depth_list = rgb_list;
    for (int i = 0; i < 3; ++i) {
      const std::string rgb_stamp = "1." + std::to_string(i) + "00000",
                        depth_stamp = "1." + std::to_string(i) + "05000";
      cv::imwrite((folder_ / "rgb" / (rgb_stamp + ".png")).string(),
                  cv::Mat(kSize, CV_8UC3, cv::Scalar(10, 20, 30 + i)));
      cv::Mat depth(kSize, CV_16UC1, cv::Scalar(5000 * (i + 1)));
      depth.at<std::uint16_t>(0, 0) = 0;
      cv::imwrite((folder_ / "depth" / (depth_stamp + ".png")).string(), depth);
      rgb_list += rgb_stamp + " rgb/" + rgb_stamp + ".png\n";
      depth_list += depth_stamp + " depth/" + depth_stamp + ".png\n";
    }
    write("rgb.txt", rgb_list);
    write("depth.txt", depth_list);
    setLogSink([this](LogLevel, const std::string& message) { messages_.push_back(message); });
  }
  void TearDown() override {
    setLogSink({});
    fs::remove_all(folder_);
  }

  void write(const std::string& name, const std::string& content) { std::ofstream(folder_ / name) << content; }
  void truncate(const std::string& name) { fs::resize_file(folder_ / name, fs::file_size(folder_ / name) / 2); }
  TumSequence open() const { return TumSequence(folder_.string(), smallCamera()); }
  /// Expects that action throws FileError with all of these words in one line.
  template <class Action>
  void expectError(Action action, const std::vector<std::string>& words) {
    try {
      action();
      ADD_FAILURE() << "no error";
    } catch (const FileError& error) {
      const std::string message = error.what();
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
      for (const auto& word : words) EXPECT_NE(message.find(word), std::string::npos) << message;
    }
  }

  fs::path folder_;
  std::vector<std::string> messages_;
};

TEST_F(TumFolder, DeliversPairedFramesInOrderThenNothing) {
  TumSequence sequence = open();
  EXPECT_EQ(sequence.size(), 3U);
  EXPECT_TRUE(sequence.groundTruth().empty());
  for (int i = 0; i < 3; ++i) {
    const auto frame = sequence.next();
    ASSERT_TRUE(frame.has_value());
    EXPECT_EQ(frame->index, static_cast<std::uint64_t>(i));
    EXPECT_EQ(frame->stamp.ns, 1000000000 + i * 100000000);
    EXPECT_EQ(frame->bgr(5, 5), cv::Vec3b(10, 20, static_cast<std::uint8_t>(30 + i)));
    EXPECT_FLOAT_EQ(frame->depth_m(5, 5), static_cast<float>(i + 1));
    EXPECT_EQ(frame->depth_m(0, 0), 0.0F);
  }
  EXPECT_FALSE(sequence.next().has_value());
  EXPECT_FALSE(sequence.next().has_value());
}

TEST_F(TumFolder, SkipPassesOverFramesAndKeepsTheirIndices) {
  TumSequence sequence = open();
  sequence.skip(2);
  EXPECT_EQ(sequence.next()->index, 2U);
  sequence.skip(5);
  EXPECT_FALSE(sequence.next().has_value());
}

TEST_F(TumFolder, AssociationsFileTakesPrecedence) {
  write("associations.txt", "1.200000 rgb/1.200000.png 1.005000 depth/1.005000.png\n");
  TumSequence sequence = open();
  ASSERT_EQ(sequence.size(), 1U);
  const auto frame = sequence.next();
  EXPECT_EQ(frame->bgr(5, 5)[2], 32);
  EXPECT_FLOAT_EQ(frame->depth_m(5, 5), 1.0F);
}

TEST_F(TumFolder, ListsOfOtherToolsAreRead) {
  const std::string rgb = (folder_ / "rgb/1.200000.png").string();
  for (const std::string& list :
       std::vector<std::string>{"1.005 depth/1.005000.png 1.2 rgb/1.200000.png\n",  // depth first
                                "\xEF\xBB\xBF"
                                "1.2,rgb/1.200000.png,1.005,depth/1.005000.png\r\n",           // a spreadsheet's
                                std::string("1.2 " + rgb + " 1.005 depth/1.005000.png\n")}) {  // an absolute path
    write("associations.txt", list);
    TumSequence sequence = open();
    ASSERT_EQ(sequence.size(), 1U) << list;
    const auto frame = sequence.next();
    EXPECT_EQ(frame->stamp.ns, 1200000000) << list;
    EXPECT_EQ(frame->bgr(5, 5)[2], 32) << list;
    EXPECT_FLOAT_EQ(frame->depth_m(5, 5), 1.0F) << list;
  }
  write("associations.txt", "1305031102175304000 rgb/1.200000.png 1305031102180000000 depth/1.005000.png\n");
  EXPECT_EQ(open().next()->stamp.ns, 1305031102175304000) << "nanoseconds";
}

TEST_F(TumFolder, ImagesWithoutAPartnerAreSaid) {
  write("depth.txt", "1.005 depth/1.005000.png\n");
  EXPECT_EQ(open().size(), 1U);
  ASSERT_FALSE(messages_.empty());
  EXPECT_NE(messages_[0].find("2 of 3 colour images"), std::string::npos) << messages_[0];
}

TEST_F(TumFolder, ReadsGroundTruthAndMaskWhereTheyAre) {
  write("groundtruth.txt", "1.0 1 2 3 0 0 0 1\n");
  cv::imwrite((folder_ / "mask/1.100000.png").string(), cv::Mat(kSize, CV_8UC1, cv::Scalar(255)));
  TumSequence sequence = open();
  EXPECT_EQ(sequence.groundTruth().size(), 1U);
  EXPECT_TRUE(sequence.groundTruthMask().empty()) << "no frame yet";
  sequence.next();
  EXPECT_TRUE(sequence.groundTruthMask().empty());
  sequence.next();
  EXPECT_EQ(cv::countNonZero(sequence.groundTruthMask()), kSize.area());
}

TEST_F(TumFolder, OneBrokenImageIsReportedSkippedAndCounted) {
  truncate("rgb/1.000000.png");
  truncate("depth/1.205000.png");
  TumSequence sequence = open();
  const auto frame = sequence.next();
  ASSERT_TRUE(frame.has_value());
  EXPECT_EQ(frame->index, 1U);
  EXPECT_FALSE(sequence.next().has_value());
  EXPECT_EQ(sequence.skippedBroken(), 2U);
  ASSERT_EQ(messages_.size(), 2U);
  EXPECT_NE(messages_[0].find("rgb/1.000000.png' is truncated"), std::string::npos) << messages_[0];
  EXPECT_NE(messages_[1].find("depth/1.205000.png' is truncated"), std::string::npos) << messages_[1];
}

TEST_F(TumFolder, TenUnreadableFramesInARowAreAnError) {
  std::string list;
  for (int i = 0; i < 10; ++i) list += "1.0" + std::to_string(i) + " rgb/gone.png 1.0 depth/1.005000.png\n";
  write("associations.txt", list);
  TumSequence sequence = open();
  expectError([&] { sequence.next(); }, {"tum_folder", "10 frames in a row", "rgb/gone.png"});
}

TEST_F(TumFolder, FirstFrameOfAnotherSizeThanTheCameraIsAnError) {
  TumSequence sequence(folder_.string(), smallCamera(640));
  expectError([&] { sequence.next(); }, {"rgb/1.000000.png", "64x48", "640x48"});
}

TEST_F(TumFolder, DepthOfEightBitsIsAnError) {
  cv::imwrite((folder_ / "depth/1.005000.png").string(), cv::Mat(kSize, CV_8UC1, cv::Scalar(50)));
  TumSequence sequence = open();
  expectError([&] { sequence.next(); }, {"depth/1.005000.png", "16-bit"});
}

TEST_F(TumFolder, MissingOrUselessPartsAreNamed) {
  expectError([&] { readTumPairs("/nonexistent/sequence"); }, {"/nonexistent/sequence", "does not exist"});
  fs::remove(folder_ / "depth.txt");
  expectError([&] { open(); }, {"depth.txt", "missing"});
  write("depth.txt", "5.0 depth/1.005000.png\n");
  expectError([&] { open(); }, {"tum_folder", "none of the 3 colour images"});
  write("depth.txt", "yesterday depth/1.005000.png\n");
  expectError([&] { open(); }, {"depth.txt", "'yesterday'"});
  write("depth.txt", "1.0\n");
  expectError([&] { open(); }, {"depth.txt", "line 1"});
  write("associations.txt", "# nothing\n");
  expectError([&] { open(); }, {"associations.txt", "no pair"});
}

TEST_F(TumFolder, TruncatedJpegIsRefusedThoughItsDecoderWouldFillItUp) {
  const std::string path = (folder_ / "image.jpg").string();
  cv::Mat noise(kSize, CV_8UC3);
  cv::randu(noise, 0, 255);
  writeImageFile(path, noise);
  EXPECT_EQ(readImageFile(path, cv::IMREAD_COLOR).size(), kSize);
  truncate("image.jpg");
  expectError([&] { readImageFile(path, cv::IMREAD_COLOR); }, {"image.jpg", "truncated"});
  expectError([&] { writeImageFile("/nonexistent/image.png", noise); }, {"/nonexistent/image.png"});
}

TEST_F(TumFolder, CameraFilesOfOtherProgramsAreNamed) {
  const auto message = [&](const std::string& content) {
    write("camera.yaml", content);
    try {
      loadCameraFile((folder_ / "camera.yaml").string());
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_NE(message("image_width: 640\ncamera_matrix: {rows: 3}\n").find("camera_calibration"), std::string::npos);
  EXPECT_NE(message("Camera.fx: 517.3\nCamera.fy: 516.5\n").find("ORB-SLAM"), std::string::npos);
  EXPECT_NE(message("cam0: {intrinsics: [1, 1, 1, 1]}\n").find("Kalibr"), std::string::npos);
  EXPECT_EQ(message("width: 64\nheight: 48\nfx: 50\nfy: 50\ncx: 32\ncy: 24\ndistortion: [0.1, 0, 0, 0]\n"), "no error");
  EXPECT_NE(message("width: 64\nheight: 48\nfx: 50\nfy: 50\ncx: 32\ncy: 24\ndistortion: [0.1]\n").find("4 or 5"),
            std::string::npos);
}

TEST(CameraFiles, AllLoadAndKeepTheBenchmarksNumbers) {
  for (const auto& entry : fs::directory_iterator("cfg/cameras")) {
    EXPECT_NO_THROW(CameraModel(loadCameraFile(entry.path().string()))) << entry.path();
  }
  const CameraIntrinsics fr1 = loadCameraFile("cfg/cameras/tum_fr1.yaml");
  EXPECT_DOUBLE_EQ(fr1.fx, 517.306408);
  EXPECT_DOUBLE_EQ(fr1.cy, 255.313989);
  EXPECT_DOUBLE_EQ(fr1.distortion[1], -0.953104);
  EXPECT_DOUBLE_EQ(fr1.distortion[4], 1.163314);
  EXPECT_EQ(loadCameraFile("cfg/cameras/tum_fr3.yaml").distortion, CameraIntrinsics().distortion);
}

}  // namespace
}  // namespace semantic_vslam
