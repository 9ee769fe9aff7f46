// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/io/image_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

std::string errorOf(const std::string& path) {
  try {
    readImageFile(path, cv::IMREAD_UNCHANGED);
  } catch (const FileError& error) {
    return error.what();
  }
  return "no error";
}

TEST(ReadImageFile, RefusesFromTheHeaderWhatWouldTakeGigabytes) {
  for (const char* kind : {".png", ".jpg"}) {
    const std::string path = testing::TempDir() + "image_file_test" + kind;
    std::vector<std::uint8_t> bytes;
    cv::imencode(kind, cv::Mat3b(48, 64), bytes);
    const auto write = [&] {
      std::ofstream(path, std::ios::binary).write(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    };
    write();
    EXPECT_EQ(errorOf(path), "no error");
    const std::uint8_t was[] = {0, 48, 0, 64};  // height and width as a JPEG has them
    if (std::string(kind) == ".png") {
      bytes[18] = bytes[22] = 0x75;  // 30016 x 30000 and a little
    } else {
      const auto found = std::search(bytes.begin(), bytes.end(), std::begin(was), std::end(was));
      ASSERT_NE(found, bytes.end());
      found[0] = found[2] = 0x75;
    }
    write();
    EXPECT_NE(errorOf(path).find("8192 px"), std::string::npos) << kind;
    std::remove(path.c_str());
  }
}

TEST(ReadImageFile, NamesAFolder) { EXPECT_NE(errorOf("/tmp").find("'/tmp' is a folder"), std::string::npos); }

}  // namespace
}  // namespace semantic_vslam
