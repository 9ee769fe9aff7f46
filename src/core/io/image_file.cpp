// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/io/image_file.h"

#include <algorithm>
#include <array>
#include <climits>
#include <fstream>
#include <iterator>
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "core/common/atomic_file.h"
#include "core/common/input_file.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::array<std::uint8_t, 4> kPngMagic = {0x89, 'P', 'N', 'G'};
constexpr std::array<std::uint8_t, 4> kPngLastChunk = {'I', 'E', 'N', 'D'};
constexpr std::array<std::uint8_t, 2> kJpegMagic = {0xFF, 0xD8};
constexpr std::array<std::uint8_t, 2> kJpegEnd = {0xFF, 0xD9};
// Some writers append a few bytes after the end mark.
constexpr std::size_t kTailBytes = 64;
// As of a camera.
constexpr int kMostSidePx = 8192;

Bytes readBytes(const std::string& path) {
  requireRegularFile("image", path);
  std::ifstream in(path, std::ios::binary);
  if (!in) throw FileError("image '" + path + "' cannot be opened");
  Bytes bytes((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  if (in.bad()) throw FileError("image '" + path + "' cannot be read");
  return bytes;
}

template <class Mark>
bool startsWith(const Bytes& bytes, const Mark& mark) {
  return bytes.size() >= mark.size() && std::equal(mark.begin(), mark.end(), bytes.begin());
}

template <class Mark>
bool tailHas(const Bytes& bytes, const Mark& mark) {
  const auto tail = bytes.end() - static_cast<std::ptrdiff_t>(std::min(bytes.size(), kTailBytes));
  return std::search(tail, bytes.end(), mark.begin(), mark.end()) != bytes.end();
}

bool truncated(const Bytes& bytes) {
  if (startsWith(bytes, kPngMagic)) return !tailHas(bytes, kPngLastChunk);
  if (startsWith(bytes, kJpegMagic)) return !tailHas(bytes, kJpegEnd);
  return bytes.empty();
}

int twoBytes(const Bytes& bytes, std::size_t at) { return bytes[at] << 8 | bytes[at + 1]; }

/// What the header of a PNG or JPEG says, before anything is decoded. @return 0x0 if it says nothing
cv::Size sizeInHeader(const Bytes& bytes) {
  constexpr std::size_t kPngSize = 16;  // width and height, four bytes each
  if (startsWith(bytes, kPngMagic) && bytes.size() >= kPngSize + 8) {
    const auto side = [&](std::size_t at) { return twoBytes(bytes, at) > 0 ? INT_MAX : twoBytes(bytes, at + 2); };
    return {side(kPngSize), side(kPngSize + 4)};
  }
  if (!startsWith(bytes, kJpegMagic)) return {};
  for (std::size_t at = kJpegMagic.size(); at + 9 <= bytes.size() && bytes[at] == 0xFF;) {
    const int marker = bytes[at + 1];
    const bool frame = marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
    if (frame) return {twoBytes(bytes, at + 7), twoBytes(bytes, at + 5)};
    at += 2 + static_cast<std::size_t>(twoBytes(bytes, at + 2));
  }
  return {};
}

}  // namespace

cv::Mat readImageFile(const std::string& path, int flags) {
  const Bytes bytes = readBytes(path);
  if (truncated(bytes)) {
    throw FileError("image '" + path + "' is truncated (" + std::to_string(bytes.size()) + " bytes)");
  }
  const cv::Size size = sizeInHeader(bytes);
  if (std::max(size.width, size.height) > kMostSidePx) {
    throw FileError("image '" + path + "' says in its header that it has more than " + std::to_string(kMostSidePx) +
                    " px a side");
  }
  cv::Mat image;
  try {
    image = cv::imdecode(bytes, flags);
  } catch (const cv::Exception&) {
    // Reported below, like an image that imdecode refuses without an exception.
  }
  if (image.empty()) throw FileError("image '" + path + "' is damaged or of an unknown format");
  return image;
}

void writeImageFile(const std::string& path, const cv::Mat& image) {
  writeFileAtomically(path, [&](const std::string& temporary) {
    bool written = false;
    try {
      written = cv::imwrite(temporary, image);
    } catch (const cv::Exception& error) {
      throw FileError("cannot write image '" + path + "': " + error.err);
    }
    if (!written) throw FileError("cannot write image '" + path + "': folder missing, not writable or disk full");
  });
}

}  // namespace semantic_vslam
