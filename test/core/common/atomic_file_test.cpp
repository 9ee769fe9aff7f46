// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/common/atomic_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

namespace fs = std::filesystem;

std::string contentOf(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

class AtomicFileTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / "atomic_file_test";
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string path(const char* name) const { return (folder_ / name).string(); }
  std::size_t files() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }

  fs::path folder_;
};

TEST_F(AtomicFileTest, KeepsTheOldFileUntilTheNewOneIsWhole) {
  writeTextAtomically(path("a"), "old");
  EXPECT_THROW(writeFileAtomically(path("a"),
                                   [](const std::string& temporary) {
                                     std::ofstream(temporary) << "half";
                                     throw std::runtime_error("the disk is full");
                                   }),
               std::runtime_error);
  EXPECT_EQ(contentOf(path("a")), "old");
  EXPECT_EQ(files(), 1U) << "nothing is left over";
  writeTextAtomically(path("a"), "new");
  EXPECT_EQ(contentOf(path("a")), "new");
}

TEST_F(AtomicFileTest, KeepsPermissions) {
  writeTextAtomically(path("a"), "old");
  ASSERT_EQ(chmod(path("a").c_str(), 0640), 0);
  writeTextAtomically(path("a"), "new");
  struct stat now {};
  ASSERT_EQ(stat(path("a").c_str(), &now), 0);
  EXPECT_EQ(now.st_mode & 07777, 0640U);
}

TEST_F(AtomicFileTest, FollowsALink) {
  writeTextAtomically(path("file"), "old");
  fs::create_symlink("file", folder_ / "link");
  writeTextAtomically(path("link"), "new");
  EXPECT_TRUE(fs::is_symlink(folder_ / "link"));
  EXPECT_EQ(contentOf(path("file")), "new");
}

TEST_F(AtomicFileTest, ReplacesNoDeviceAndNoFolder) {
  for (const std::string& target : {std::string("/dev/null"), folder_.string()}) {
    try {
      writeTextAtomically(target, "x");
      FAIL() << target;
    } catch (const FileError& error) {
      EXPECT_NE(std::string(error.what()).find(target), std::string::npos);
    }
  }
  EXPECT_FALSE(fs::is_regular_file("/dev/null"));
}

TEST_F(AtomicFileTest, RemovesWhatKilledProgramsLeftAndNothingElse) {
  const std::string mine = ".writing-" + std::to_string(getpid()) + "-0123-a";
  for (const char* name : {".writing-999999999-0123-a", mine.c_str(), "a", ".writing-x"})
    std::ofstream(path(name)) << "x";
  removeLeftOvers(folder_.string());
  EXPECT_EQ(files(), 3U);
  EXPECT_FALSE(fs::exists(path(".writing-999999999-0123-a")));
  removeLeftOvers("/nonexistent");
}

}  // namespace
}  // namespace semantic_vslam
