// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/bag_records.h"

#include <rosbag/view.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 30;
constexpr std::uint32_t kLongestHeader = 1 << 20;

/// Reads a bag's records, without what they hold.
class Records {
 public:
  explicit Records(const std::string& path)
      : path_(path), file_(path, std::ios::binary), left_(std::filesystem::file_size(path)) {}

  /// @return whether the file is a bag of this format; rosbag tells about all others
  bool begin() {
    constexpr char kMagic[] = "#ROSBAG V2.0\n";
    char magic[sizeof(kMagic) - 1] = {};
    return take(magic, sizeof(magic)) && std::memcmp(magic, kMagic, sizeof(magic)) == 0;
  }

  bool atEnd() const { return left_ == 0; }

  void walkOver() {
    const std::uint32_t header_bytes = length();
    if (header_bytes > kLongestHeader) damaged();
    std::string header(header_bytes, '\0');
    if (!take(&header[0], header.size())) damaged();
    checkUnpackedSize(header);
    const std::uint32_t data_bytes = length();
    if (data_bytes > left_) damaged();
    file_.seekg(data_bytes, std::ios::cur);
    left_ -= data_bytes;
  }

 private:
  bool take(char* data, std::size_t bytes) {
    if (bytes > left_ || !file_.read(data, static_cast<std::streamsize>(bytes))) return false;
    left_ -= bytes;
    return true;
  }
  std::uint32_t length() {
    char bytes[4];
    if (!take(bytes, sizeof(bytes))) damaged();
    std::uint32_t value = 0;
    std::memcpy(&value, bytes, sizeof(value));
    return value;
  }
  /// A chunk's header says how large it is when it is unpacked.
  void checkUnpackedSize(const std::string& header) const {
    for (std::size_t at = 0; at + 4 <= header.size();) {
      std::uint32_t field_bytes = 0;
      std::memcpy(&field_bytes, header.data() + at, sizeof(field_bytes));
      at += 4;
      if (field_bytes > header.size() - at) damaged();
      constexpr char kSize[] = "size=";
      if (field_bytes == 9 && header.compare(at, 5, kSize) == 0) {
        std::uint32_t unpacked = 0;
        std::memcpy(&unpacked, header.data() + at + 5, sizeof(unpacked));
        if (unpacked > kMostBytes) damaged();
      }
      at += field_bytes;
    }
  }
  [[noreturn]] void damaged() const {
    throw FileError("bag '" + path_ + "' is truncated or damaged: a record's length leads out of it; `rosbag fix` or " +
                    "`rosbag reindex` may mend it");
  }

  const std::string path_;
  std::ifstream file_;
  std::uint64_t left_;
};

}  // namespace

void checkBagRecords(const std::string& path) {
  Records records(path);
  if (!records.begin()) return;
  while (!records.atEnd()) records.walkOver();
}

std::size_t forEachMessage(const rosbag::Bag& bag, const std::vector<std::string>& topics,
                           const std::function<void(const rosbag::MessageInstance&)>& visit) {
  std::size_t left_out = 0;
  rosbag::View view(bag, rosbag::TopicQuery(topics));
  for (const rosbag::MessageInstance& message : view) {
    try {
      visit(message);
    } catch (const Error&) {
      throw;
    } catch (const std::exception&) {  // rosbag and the deserialiser
      ++left_out;
    }
  }
  return left_out;
}

}  // namespace semantic_vslam
