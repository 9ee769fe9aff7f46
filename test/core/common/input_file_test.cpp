// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/common/input_file.h"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <cstdio>
#include <fstream>

#include "semantic_vslam/core/common/config_fields.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

/// @return what reading the text as a configuration file says
std::string errorOf(const std::string& text) {
  const std::string path = testing::TempDir() + "input_file_test.yaml";
  std::ofstream(path) << text;
  std::string message = "no error";
  try {
    readConfigFile(path);
  } catch (const FileError& error) {
    message = error.what();
    EXPECT_NE(message.find(path), std::string::npos) << "every message names the file";
  }
  std::remove(path.c_str());
  return message;
}

TEST(YamlFile, IsRefusedWhereItWouldEndInNothingOrInGigabytes) {
  EXPECT_EQ(errorOf("motion: {model: none}\n"), "no error");
  EXPECT_NE(errorOf("motion: &m\n  model: *m\n").find("aliases"), std::string::npos) << "refers to itself";
  std::string laughs = "a0: &a0 [x, x, x, x, x, x, x, x, x]\n";
  for (int i = 1; i < 9; ++i) {
    const std::string before = "*a" + std::to_string(i - 1);
    laughs += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + before;
    for (int k = 0; k < 8; ++k) laughs += ", " + before;
    laughs += "]\n";
  }
  EXPECT_NE(errorOf(laughs).find("aliases"), std::string::npos);
  std::string deep;
  for (int i = 0; i < 20000; ++i) deep += "{a: ";
  EXPECT_NE(errorOf(deep), "no error");
  EXPECT_NE(errorOf("a: " + std::string(5 << 20, 'x')).find("4 MB"), std::string::npos);
}

TEST(YamlFile, AKeyThatIsSaidTwiceIsNamed) {
  EXPECT_NE(errorOf("motion: {model: none}\nfrozen: 1\nmotion: {model: homography}\n").find("'motion' is said twice"),
            std::string::npos);
  EXPECT_NE(errorOf("motion:\n  model: none\n  model: homography\n").find("'model' is said twice"), std::string::npos);
  EXPECT_NE(errorOf("motion: {[a, b]: none}\n").find("a key must be a word"), std::string::npos);
  EXPECT_EQ(errorOf("a: {x: 1}\nb: {x: 2}\nc: \nd: \"\"\n"), "no error")
      << "in other maps the same name is another key";
}

TEST(YamlFile, FoldersAndDevicesAreNamed) {
  for (const char* path : {"/dev/zero", "/tmp"}) {
    try {
      readConfigFile(path);
      FAIL() << path;
    } catch (const FileError& error) {
      EXPECT_NE(std::string(error.what()).find(path), std::string::npos);
    }
  }
}

TEST(Printable, GivesATerminalNothingToObey) {
  EXPECT_EQ(printable("a\nb\x1b[2Jc\x7f"), "a\\x0Ab\\x1B[2Jc\\x7F");
  EXPECT_EQ(printable("\xC2\x9B"
                      "31m"),
            "\\xC2\\x9B31m");
  EXPECT_EQ(printable("Gr\xC3\xBC\xC3\x9F"
                      "e"),
            "Gr\xC3\xBC\xC3\x9F"
            "e");
}

}  // namespace
}  // namespace semantic_vslam
