// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/common/binary_file.h"

#include <array>
#include <cerrno>
#include <fstream>
#include <iterator>

#include "core/common/input_file.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

constexpr std::size_t kMagicBytes = 8;
constexpr std::size_t kHeaderBytes =
    kMagicBytes + sizeof(std::uint32_t) + sizeof(std::uint64_t) + sizeof(std::uint32_t);

/// CRC-32 as in zip and PNG (polynomial 0xEDB88320, reflected).
std::uint32_t crc32(const char* data, std::size_t size) {
  static const auto table = [] {
    std::array<std::uint32_t, 256> t{};
    for (std::uint32_t i = 0; i < t.size(); ++i) {
      std::uint32_t c = i;
      for (int bit = 0; bit < 8; ++bit) c = (c & 1U) != 0 ? 0xEDB88320U ^ (c >> 1) : c >> 1;
      t[i] = c;
    }
    return t;
  }();
  std::uint32_t crc = 0xFFFFFFFFU;
  for (std::size_t i = 0; i < size; ++i) crc = table[(crc ^ static_cast<std::uint8_t>(data[i])) & 0xFFU] ^ (crc >> 8);
  return crc ^ 0xFFFFFFFFU;
}

}  // namespace

std::string BinaryWriter::file(const BinaryFormat& format) const {
  BinaryWriter file;
  file.putBytes(format.magic, kMagicBytes);
  file.put(format.version);
  file.putCount(bytes_.size());
  file.put(crc32(bytes_.data(), bytes_.size()));
  file.bytes_ += bytes_;
  return std::move(file.bytes_);
}

BinaryReader::BinaryReader(const std::string& content, const BinaryFormat& format, std::string name)
    : bytes_(content), kind_(format.name), name_(std::move(name)) {
  const std::string file = std::string(kind_) + " '" + name_ + "' ";
  if (content.size() < kMagicBytes || std::memcmp(content.data(), format.magic, kMagicBytes) != 0) {
    throw FileError("'" + name_ + "' is no " + kind_ + " of semantic_vslam");
  }
  const std::string truncated = file + "is truncated: save or copy it anew";
  if (content.size() < kHeaderBytes) throw FileError(truncated);
  at_ = kMagicBytes;
  const auto version = get<std::uint32_t>();
  if (version != format.version) {
    throw FileError(file + "has format version " + std::to_string(version) + ", this program reads " +
                    std::to_string(format.version) + ": save it anew with this program");
  }
  const auto payload_bytes = get<std::uint64_t>();
  const auto checksum = get<std::uint32_t>();
  if (content.size() - kHeaderBytes < payload_bytes) throw FileError(truncated);
  if (content.size() - kHeaderBytes > payload_bytes ||
      crc32(content.data() + kHeaderBytes, content.size() - kHeaderBytes) != checksum) {
    throw FileError(file + "is damaged: its checksum does not fit; save or copy it anew");
  }
}

void BinaryReader::require(bool consistent) const {
  if (!consistent) {
    throw FileError(std::string(kind_) + " '" + name_ + "' is damaged: its content contradicts itself; save it anew");
  }
}

std::string readBinaryFile(const BinaryFormat& format, const std::string& path) {
  requireRegularFile(format.name, path);
  const std::string file_of_kind = std::string(format.name) + " '" + path + "' ";
  std::ifstream file(path, std::ios::binary);
  if (!file) throw FileError(file_of_kind + "cannot be opened: " + std::strerror(errno));
  std::string content((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  if (file.bad()) throw FileError(file_of_kind + "cannot be read: " + std::strerror(errno));
  return content;
}

}  // namespace semantic_vslam
