// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/io/image_file.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "core/common/atomic_file.h"
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

Bytes readBytes(const std::string& path) {
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

}  // namespace

cv::Mat readImageFile(const std::string& path, int flags) {
  const Bytes bytes = readBytes(path);
  if (truncated(bytes)) {
    throw FileError("image '" + path + "' is truncated (" + std::to_string(bytes.size()) + " bytes)");
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
