// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/io/trajectory.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "core/io/stamp_association.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

std::string writeTemporary(const std::string& name, const std::string& content) {
  const std::string path = testing::TempDir() + name;
  std::ofstream(path) << content;
  return path;
}

std::string readAll(const std::string& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

std::vector<Stamp> stampsMs(const std::vector<int>& milliseconds) {
  std::vector<Stamp> stamps;
  for (const int ms : milliseconds) stamps.push_back(Stamp{std::int64_t{ms} * 1000000});
  return stamps;
}

TEST(ParseStamp, KeepsEveryNanosecond) {
  EXPECT_EQ(parseStamp("1305031102.175304")->ns, 1305031102175304000);
  EXPECT_EQ(parseStamp("1305031102.175304321")->ns, 1305031102175304321);
  EXPECT_EQ(parseStamp("1305031102.1753043219")->ns, 1305031102175304321);
  EXPECT_EQ(parseStamp("1305031098.6659")->ns, 1305031098665900000);
  EXPECT_EQ(parseStamp("12")->ns, 12000000000);
  EXPECT_EQ(parseStamp(".5")->ns, 500000000);
  EXPECT_EQ(parseStamp("-0.25")->ns, -250000000);
  EXPECT_EQ(parseStamp("1.305031102175304000e+09")->ns, 1305031102175304000);
}

TEST(ParseStamp, RefusesWhatIsNoNumber) {
  for (const char* text : {"", "-", ".", "abc", "12x", "1.2.3", "1 2", "99999999999999999999", "1e", "nan"}) {
    EXPECT_FALSE(parseStamp(text).has_value()) << "'" << text << "'";
  }
}

TEST(FormatStamp, WritesSixToNineDecimals) {
  EXPECT_EQ(formatStamp(Stamp{1305031102175304000}), "1305031102.175304");
  EXPECT_EQ(formatStamp(Stamp{1305031102175304321}), "1305031102.175304321");
  EXPECT_EQ(formatStamp(Stamp{1305031102000000000}), "1305031102.000000");
  EXPECT_EQ(formatStamp(Stamp{-250000000}), "-0.250000");
}

TEST(TumTrajectory, WhatIsWrittenIsReadBack) {
  std::vector<TimedPose> poses(2);
  poses[0].stamp.ns = 1305031102175304321;
  poses[0].T_world_camera = makeSE3(Eigen::Quaterniond(0.5, -0.5, 0.5, 0.5), {1.25, -2.5, 0.0000001});
  poses[1].stamp.ns = 1305031102211214000;
  const std::string path = testing::TempDir() + "trajectory.txt";
  writeTumTrajectory(path, poses);

  const auto read = readTumTrajectory(path);
  ASSERT_EQ(read.size(), 2U);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(read[i].stamp, poses[i].stamp);
    EXPECT_TRUE(read[i].T_world_camera.isApprox(poses[i].T_world_camera, 1e-8));
  }
  EXPECT_EQ(readAll(path),
            "# timestamp tx ty tz qx qy qz qw\n"
            "1305031102.175304321 1.2500000 -2.5000000 0.0000001 -0.500000000 0.500000000 0.500000000 0.500000000\n"
            "1305031102.211214 0.0000000 0.0000000 0.0000000 0.000000000 0.000000000 0.000000000 1.000000000\n");
  std::remove(path.c_str());
}

TEST(TumTrajectory, ReadsCommasCommentsAndUnsortedLinesAndLeavesOutNan) {
  const std::string path = writeTemporary("odd.txt",
                                          "# comment\n\n"
                                          "2.0,1,2,3,0,0,0,1\r\n"
                                          "1.0\t4 5 6 0 0 0 1\n"
                                          "3.0 nan 0 0 0 0 0 1\n"
                                          "2.0 7 8 9 0 0 0 1\n");
  const auto poses = readTumTrajectory(path);
  ASSERT_EQ(poses.size(), 2U);
  EXPECT_EQ(poses[0].stamp.ns, 1000000000);
  EXPECT_TRUE(poses[0].T_world_camera.translation().isApprox(Eigen::Vector3d(4, 5, 6)));
  EXPECT_TRUE(poses[1].T_world_camera.translation().isApprox(Eigen::Vector3d(7, 8, 9))) << "the later line counts";
  std::remove(path.c_str());
}

TEST(TumTrajectory, NamesFileAndLineOfAnError) {
  const std::string path = writeTemporary("bad.txt", "# c\n1.0 0 0 0 0 0 0 1\n2.0 0 0 oops 0 0 0 1\n");
  try {
    readTumTrajectory(path);
    FAIL() << "no error";
  } catch (const FileError& error) {
    EXPECT_NE(std::string(error.what()).find("bad.txt', line 3"), std::string::npos) << error.what();
  }
  std::remove(path.c_str());
  EXPECT_THROW(readTumTrajectory("/nonexistent/trajectory.txt"), FileError);
}

TEST(TumTrajectory, RefusesPosesThatCannotBe) {
  for (const char* line :
       {"1.0 0 0 0 0 0 0 0", "1.0 1e160 0 0 0 0 0 1", "1.0 0 0 -inf 0 0 0 1", "1e300 0 0 0 0 0 0 1"}) {
    const std::string path = writeTemporary("cannot_be.txt", std::string(line) + "\n");
    EXPECT_THROW(readTumTrajectory(path), FileError) << line;
    std::remove(path.c_str());
  }
  EXPECT_THROW(readTumTrajectory("/dev/zero"), FileError);
}

TEST(TumTrajectory, UnwritableFolderIsAnErrorThatNamesTheFile) {
  for (const char* path : {"/nonexistent/folder/trajectory.txt", "/proc/trajectory.txt"}) {
    try {
      writeTumTrajectory(path, {});
      FAIL() << "no error";
    } catch (const FileError& error) {
      EXPECT_NE(std::string(error.what()).find(path), std::string::npos) << error.what();
    }
  }
}

TEST(TumTrajectory, WriteThatFailsHalfwayKeepsTheOldFileAndLeavesNoPart) {
  const std::string folder = testing::TempDir() + "halfway";
  std::filesystem::create_directories(folder);
  const std::string path = folder + "/trajectory.txt";
  writeTumTrajectory(path, {TimedPose{}});
  const std::string before = readAll(path);

  // A limit on the file size makes the write fail part of the way, as a full disk does.
  rlimit old_limit{};
  getrlimit(RLIMIT_FSIZE, &old_limit);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{1000, old_limit.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  EXPECT_THROW(writeTumTrajectory(path, std::vector<TimedPose>(1000)), FileError);
  setrlimit(RLIMIT_FSIZE, &old_limit);
  std::signal(SIGXFSZ, old_handler);

  EXPECT_EQ(readAll(path), before);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1);
  std::filesystem::remove_all(folder);
}

TEST(ClosestPose, IsTheNearestInTimeAndTheEarlierOfTwo) {
  const std::vector<TimedPose> poses = {{Stamp{10}}, {Stamp{20}}, {Stamp{40}}};
  EXPECT_EQ(closestPose(poses, Stamp{0}), &poses[0]);
  EXPECT_EQ(closestPose(poses, Stamp{15}), &poses[0]);
  EXPECT_EQ(closestPose(poses, Stamp{16}), &poses[1]);
  EXPECT_EQ(closestPose(poses, Stamp{40}), &poses[2]);
  EXPECT_EQ(closestPose(poses, Stamp{90}), &poses[2]);
}

TEST(ClosestPose, IsNoneBeyondTheGap) {
  const std::vector<TimedPose> poses = {{Stamp{0}}, {Stamp{1'000'000'000}}};
  EXPECT_EQ(closestPose(poses, Stamp{1'250'000'000}, 0.25), &poses[1]);
  EXPECT_EQ(closestPose(poses, Stamp{1'250'000'001}, 0.25), nullptr);
  EXPECT_EQ(closestPose({}, Stamp{0}), nullptr);
}

TEST(AssociateStamps, TakesTheClosestPairFirstAndEachStampOnce) {
  // a[0] is 6 from b[0]; a[1] is 4 from it and wins; a[0] has no other within the gap.
  const auto pairs = associateStamps(stampsMs({100, 110, 200}), stampsMs({106, 219}), 0.02);
  ASSERT_EQ(pairs.size(), 2U);
  EXPECT_EQ(pairs[0], std::make_pair(std::size_t{1}, std::size_t{0}));
  EXPECT_EQ(pairs[1], std::make_pair(std::size_t{2}, std::size_t{1}));
}

TEST(AssociateStamps, RefusesToPairEverythingWithEverything) {
  const std::vector<Stamp> all_the_same(20000);
  EXPECT_THROW(associateStamps(all_the_same, all_the_same, 0.02), Error) << "9.6 GB";
}

TEST(AssociateStamps, GapIsExclusiveAndOrderOfInputDoesNotMatter) {
  EXPECT_TRUE(associateStamps(stampsMs({100}), stampsMs({120}), 0.02).empty());
  EXPECT_TRUE(associateStamps(stampsMs({100}), stampsMs({80}), 0.02).empty());
  const auto pairs = associateStamps(stampsMs({300, 100}), stampsMs({119, 281}), 0.02);
  ASSERT_EQ(pairs.size(), 2U);
  EXPECT_EQ(pairs[0], std::make_pair(std::size_t{0}, std::size_t{1}));
  EXPECT_EQ(pairs[1], std::make_pair(std::size_t{1}, std::size_t{0}));
}

}  // namespace
}  // namespace semantic_vslam
