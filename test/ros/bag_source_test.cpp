// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/bag_source.h"

#include <gtest/gtest.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <sys/resource.h>

#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>

#include "ros/conversions.h"
#include "ros/recording_bag.h"
#include "semantic_vslam/core/common/error.h"
#include "semantic_vslam/core/common/log.h"

namespace semantic_vslam {
namespace {

namespace fs = std::filesystem;

const cv::Size kSize(64, 48);

CameraIntrinsics smallCamera() {
  CameraIntrinsics k;
  k.width = kSize.width;
  k.height = kSize.height;
  k.fx = 50.0;
  k.fy = 51.0;
  k.cx = 31.5;
  k.cy = 23.5;
  k.distortion = {0.1, -0.2, 0.001, 0.002, 0.05};
  return k;
}

Stamp atMs(std::int64_t ms) { return Stamp{1'000'000'000'000 + ms * 1'000'000}; }

SE3 truePose(int i) { return se3Exp((Vector6d() << 0.1 * i, 0.2, 1.0, 0.3, -0.1 * i, 0.5).finished()); }

cv::Mat1f depthImage(int i) {
  cv::Mat1f depth(kSize, 1.0F + static_cast<float>(i));
  depth(0, 0) = 0.0F;
  return depth;
}

class BagSourceTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / "bag_source_test";
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    path_ = (folder_ / "recording.bag").string();
    setLogSink([this](LogLevel, const std::string& message) { messages_.push_back(message); });
  }
  void TearDown() override {
    setLogSink({});
    fs::remove_all(folder_);
  }

  /// Three frames at 0, 100 and 200 ms; depth 5 ms late; a mask on the second; true poses every 10 ms.
  void writeRecording() {
    RecordingBag bag(path_, smallCamera(), rosbag::compression::LZ4);
    for (int i = 0; i < 3; ++i) {
      bag.writeColour(atMs(100 * i), cv::Mat3b(kSize, cv::Vec3b(10, 20, static_cast<std::uint8_t>(30 + i))));
      bag.writeDepth(atMs(100 * i + 5), depthImage(i));
    }
    bag.writeMask(atMs(100), cv::Mat1b(kSize, std::uint8_t{255}));
    for (int i = 0; i <= 20; ++i) bag.writeTruePose(atMs(10 * i), truePose(i));
    bag.close();
  }

  static sensor_msgs::Image image(Stamp stamp, const std::string& encoding, int bytes_per_pixel) {
    sensor_msgs::Image out;
    out.header.stamp = toRos(stamp);
    out.header.frame_id = "camera";
    out.encoding = encoding;
    out.width = static_cast<std::uint32_t>(kSize.width);
    out.height = static_cast<std::uint32_t>(kSize.height);
    out.step = out.width * static_cast<std::uint32_t>(bytes_per_pixel);
    out.data.assign(out.step * out.height, 1);
    return out;
  }

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
  void expectOpenError(const std::vector<std::string>& words) {
    expectError([&] { BagSource(path_, nullptr); }, words);
  }

  fs::path folder_;
  std::string path_;
  std::vector<std::string> messages_;
};

TEST_F(BagSourceTest, GivesBackWhatWasRecorded) {
  writeRecording();
  BagSource source(path_, nullptr);
  EXPECT_EQ(source.size(), 3U);
  EXPECT_EQ(source.topics().colour, "/camera/rgb/image_color");
  EXPECT_EQ(source.camera()->intrinsics().fy, 51.0);
  EXPECT_EQ(source.camera()->intrinsics().distortion, smallCamera().distortion);
  for (int i = 0; i < 3; ++i) {
    const auto frame = source.next();
    ASSERT_TRUE(frame.has_value());
    EXPECT_EQ(frame->index, static_cast<std::uint64_t>(i));
    EXPECT_EQ(frame->stamp, atMs(100 * i));
    EXPECT_EQ(frame->bgr(7, 9), cv::Vec3b(10, 20, static_cast<std::uint8_t>(30 + i)));
    EXPECT_EQ(frame->depth_m(7, 9), 1.0F + static_cast<float>(i));
    EXPECT_EQ(frame->depth_m(0, 0), 0.0F) << "NaN in the bag";
    EXPECT_EQ(source.groundTruthMask().empty(), i != 1);
  }
  EXPECT_FALSE(source.next().has_value());
  EXPECT_TRUE(messages_.empty());
}

TEST_F(BagSourceTest, GroundTruthIsTheTfChainFromWorldToTheOpticalFrame) {
  writeRecording();
  const BagSource source(path_, nullptr);
  ASSERT_EQ(source.groundTruth().size(), 21U);
  for (int i = 0; i <= 20; ++i) {
    EXPECT_EQ(source.groundTruth()[i].stamp, atMs(10 * i));
    EXPECT_TRUE(source.groundTruth()[i].T_world_camera.isApprox(truePose(i), 1e-9));
  }
}

TEST_F(BagSourceTest, SkipKeepsIndicesAndAGivenCameraReplacesCameraInfo) {
  writeRecording();
  CameraIntrinsics other = smallCamera();
  other.fx = 60.0;
  BagSource source(path_, std::make_shared<CameraModel>(other));
  EXPECT_EQ(source.camera()->fx(), 60.0);
  source.skip(2);
  EXPECT_EQ(source.next()->index, 2U);
  EXPECT_FALSE(source.next().has_value());
}

TEST_F(BagSourceTest, RealSenseTopicsInMillimetresAreRecognised) {
  {
    rosbag::Bag bag(path_, rosbag::bagmode::Write);
    bag.write("/camera/color/image_raw", toRos(atMs(0)), image(atMs(0), "rgb8", 3));
    bag.write("/camera/aligned_depth_to_color/image_raw", toRos(atMs(0)), image(atMs(0), "16UC1", 2));
    sensor_msgs::CameraInfo info;
    info.width = 64;
    info.height = 48;
    info.distortion_model = "plumb_bob";
    info.K = {50, 0, 32, 0, 50, 24, 0, 0, 1};
    bag.write("/camera/color/camera_info", toRos(atMs(0)), info);
  }
  BagSource source(path_, nullptr);
  EXPECT_FLOAT_EQ(source.next()->depth_m(3, 3), 0.257F);  // 0x0101 mm
  EXPECT_TRUE(source.groundTruth().empty());
}

TEST_F(BagSourceTest, OtherTopicsCanBeNamed) {
  {
    rosbag::Bag bag(path_, rosbag::bagmode::Write);
    bag.write("/left/image", toRos(atMs(0)), image(atMs(0), "mono8", 1));
    bag.write("/left/depth", toRos(atMs(3)), image(atMs(3), "16UC1", 2));
  }
  BagSource source(path_, std::make_shared<CameraModel>(smallCamera()), {"/left/image", "/left/depth", ""});
  EXPECT_EQ(source.next()->gray(0, 0), 1);
  expectOpenError({"recording.bag", "no known pair", "/left/image (sensor_msgs/Image)"});
  expectError([&] { BagSource(path_, nullptr, {"/right/image", "/left/depth", ""}); }, {"/right/image", "/left/image"});
}

TEST_F(BagSourceTest, MissingTruncatedAndForeignFilesAreNamed) {
  expectOpenError({"recording.bag", "does not exist"});
  writeRecording();
  fs::resize_file(path_, fs::file_size(path_) / 2);
  expectOpenError({"recording.bag", "truncated"});
  fs::resize_file(path_, 0);
  expectOpenError({"recording.bag"});
  fs::resize_file(path_, 5000);
  expectOpenError({"recording.bag"});
}

TEST_F(BagSourceTest, ADamagedChunkCostsItsOwnMessages) {
  {
    rosbag::Bag bag(path_, rosbag::bagmode::Write);
    bag.setCompression(rosbag::compression::LZ4);
    bag.setChunkThreshold(20'000);  // a few images
    sensor_msgs::CameraInfo info;
    info.width = static_cast<std::uint32_t>(kSize.width);
    info.height = static_cast<std::uint32_t>(kSize.height);
    info.K = {100, 0, 16, 0, 100, 12, 0, 0, 1};
    info.distortion_model = "plumb_bob";
    info.D.resize(5);
    std::mt19937 noise(1);
    for (int i = 0; i < 30; ++i) {
      auto colour = image(atMs(100 * i), "rgb8", 3), depth = image(atMs(100 * i), "16UC1", 2);
      for (auto* bytes : {&colour.data, &depth.data}) {
        for (std::uint8_t& byte : *bytes) byte = static_cast<std::uint8_t>(noise());
      }
      bag.write("/camera/rgb/camera_info", toRos(atMs(100 * i)), info);
      bag.write("/camera/rgb/image_color", toRos(atMs(100 * i)), colour);
      bag.write("/camera/depth/image", toRos(atMs(100 * i)), depth);
    }
  }
  {
    std::fstream file(path_, std::ios::in | std::ios::out | std::ios::binary);
    const auto middle = static_cast<std::streamoff>(fs::file_size(path_) / 2);
    file.seekg(middle);
    const char flipped = static_cast<char>(file.get() ^ 0x10);
    file.seekp(middle);
    file.put(flipped);
  }
  BagSource bag(path_, nullptr);
  std::size_t frames = 0;
  while (bag.next()) ++frames;
  EXPECT_GE(frames, 20U);
  EXPECT_LT(frames, 30U);
  ASSERT_FALSE(messages_.empty());
  EXPECT_NE(messages_[0].find("is damaged"), std::string::npos) << messages_[0];
}

TEST_F(BagSourceTest, ALengthThatLeadsOutOfTheBagIsRefusedBeforeMemoryIsTaken) {
  writeRecording();
  const auto size = static_cast<std::streamoff>(fs::file_size(path_));
  // The first record's header and data, and what follows the 4096 bytes that a bag begins with.
  for (const std::streamoff at : {13, 13 + 4096 + 8, 13 + 4096 + 8 + 4}) {
    ASSERT_LT(at, size);
    std::fstream file(path_, std::ios::in | std::ios::out | std::ios::binary);
    char kept[4];
    file.seekg(at);
    file.read(kept, 4);
    file.seekp(at);
    file.write("\xff\xff\xff\xff", 4);
    file.close();
    expectOpenError({"recording.bag", "damaged"});
    file.open(path_, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(at);
    file.write(kept, 4);
  }
  EXPECT_NO_THROW(BagSource(path_, nullptr));
}

TEST_F(BagSourceTest, AbsentCameraInfoAsksForACameraFile) {
  {
    rosbag::Bag bag(path_, rosbag::bagmode::Write);
    bag.write(kTumTopics.colour, toRos(atMs(0)), image(atMs(0), "rgb8", 3));
    bag.write(kTumTopics.depth, toRos(atMs(0)), image(atMs(0), "16UC1", 2));
  }
  expectOpenError({"recording.bag", "/camera/rgb/camera_info", "camera file"});
}

TEST_F(BagSourceTest, WrongEncodingOfTheFirstFrameIsNamed) {
  {
    rosbag::Bag bag(path_, rosbag::bagmode::Write);
    bag.write(kTumTopics.colour, toRos(atMs(0)), image(atMs(0), "bayer_rggb16", 2));
    bag.write(kTumTopics.depth, toRos(atMs(0)), image(atMs(0), "32FC1", 4));
  }
  BagSource source(path_, std::make_shared<CameraModel>(smallCamera()));
  expectError([&] { source.next(); }, {"recording.bag", "bayer_rggb16", "rgb8"});
}

TEST_F(BagSourceTest, ImagesTooFarApartInTimeAreNamed) {
  {
    rosbag::Bag bag(path_, rosbag::bagmode::Write);
    bag.write(kTumTopics.colour, toRos(atMs(0)), image(atMs(0), "rgb8", 3));
    bag.write(kTumTopics.depth, toRos(atMs(20)), image(atMs(20), "32FC1", 4));
  }
  expectOpenError({"recording.bag", "none of the 1 images", "/camera/depth/image"});
}

TEST_F(BagSourceTest, UncalibratedDriverDefaultIsWarnedAbout) {
  CameraIntrinsics k;  // 525 px, as the driver says without a calibration
  {
    RecordingBag bag(path_, k, rosbag::compression::Uncompressed);
    bag.writeColour(atMs(0), cv::Mat3b(480, 640, cv::Vec3b(1, 2, 3)));
    bag.writeDepth(atMs(0), cv::Mat1f(480, 640, 1.0F));
    bag.close();
  }
  BagSource source(path_, nullptr);
  ASSERT_EQ(messages_.size(), 1U);
  EXPECT_NE(messages_[0].find("uncalibrated"), std::string::npos);
  EXPECT_TRUE(source.next().has_value());
}

TEST_F(BagSourceTest, ABagThatIsNotClosedLeavesNothingBehind) {
  {
    RecordingBag bag(path_, smallCamera(), rosbag::compression::Uncompressed);
    bag.writeDepth(atMs(0), depthImage(0));
  }
  EXPECT_TRUE(fs::is_empty(folder_));
  expectError([&] { RecordingBag("/nonexistent/a.bag", smallCamera(), rosbag::compression::Uncompressed); },
              {"/nonexistent/a.bag"});
}

TEST_F(BagSourceTest, AFullDiskIsOneErrorThatNamesTheBag) {
  rlimit old_limit{};
  getrlimit(RLIMIT_FSIZE, &old_limit);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{200'000, old_limit.rlim_max};  // a file may grow to this size only, as on a full disk
  expectError(
      [&] {
        RecordingBag bag(path_, smallCamera(), rosbag::compression::Uncompressed);
        setrlimit(RLIMIT_FSIZE, &small);
        for (int i = 0; i < 1000; ++i) bag.writeDepth(atMs(i), depthImage(0));
        bag.close();
      },
      {"recording.bag", "disk full"});
  setrlimit(RLIMIT_FSIZE, &old_limit);
  std::signal(SIGXFSZ, old_handler);
  EXPECT_TRUE(fs::is_empty(folder_));
}

}  // namespace
}  // namespace semantic_vslam
