// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <utility>

#include "semantic_vslam/core/common/ids.h"

#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "binary files are little-endian: byte swaps are missing here"
#endif

namespace semantic_vslam {

/// Kind of a binary file. Little-endian, in this order:
///     magic, u32 format version, u64 bytes of payload, u32 CRC-32 of payload, payload
struct BinaryFormat {
  char magic[9];  ///< 8 characters
  std::uint32_t version;
  const char* name;  ///< for messages, as in "map file"
};

/// Payload of a binary file.
class BinaryWriter {
 public:
  template <class T>
  void put(const T& value) {
    static_assert(std::is_arithmetic<T>::value, "write members one by one: structs have padding");
    putBytes(&value, sizeof(value));
  }
  void putBytes(const void* data, std::size_t size) { bytes_.append(static_cast<const char*>(data), size); }
  void putCount(std::size_t count) { put(static_cast<std::uint64_t>(count)); }
  void putText(const std::string& text) {
    putCount(text.size());
    putBytes(text.data(), text.size());
  }
  template <class Tag>
  void putId(Id<Tag> id) {
    put(id.value());
  }
  template <class Derived>
  void putMatrix(const Eigen::MatrixBase<Derived>& m) {
    for (Eigen::Index r = 0; r < m.rows(); ++r) {
      for (Eigen::Index c = 0; c < m.cols(); ++c) put(m(r, c));
    }
  }
  /// @return the whole file
  std::string file(const BinaryFormat& format) const;

 private:
  std::string bytes_;
};

/// Reads what BinaryWriter wrote; every step past the end or out of range is a FileError.
class BinaryReader {
 public:
  /// @param content  of the file  @param name  of it, for messages
  /// @throws FileError, one line, if that is not of this format or version, truncated or damaged
  BinaryReader(const std::string& content, const BinaryFormat& format, std::string name);

  template <class T>
  T get() {
    T value;
    getBytes(&value, sizeof(value));
    return value;
  }
  void getBytes(void* data, std::size_t size) {
    require(size <= bytes_.size() - at_);
    std::memcpy(data, bytes_.data() + at_, size);
    at_ += size;
  }
  /// A number of items of at least item_bytes each: more than the file can hold is refused before memory is taken.
  std::size_t getCount(std::size_t item_bytes) {
    const auto count = get<std::uint64_t>();
    require(count <= (bytes_.size() - at_) / item_bytes);
    return static_cast<std::size_t>(count);
  }
  std::string getText() {
    std::string text(getCount(1), '\0');
    getBytes(&text[0], text.size());
    return text;
  }
  template <class SomeId>
  SomeId getId() {
    return SomeId(get<std::uint64_t>());
  }
  template <class Derived>
  void getMatrix(Eigen::MatrixBase<Derived>& m) {
    for (Eigen::Index r = 0; r < m.rows(); ++r) {
      for (Eigen::Index c = 0; c < m.cols(); ++c) m(r, c) = get<typename Derived::Scalar>();
    }
  }
  bool atEnd() const { return at_ == bytes_.size(); }
  /// @throws FileError that says that the file contradicts itself, if so
  void require(bool consistent) const;

 private:
  const std::string& bytes_;
  std::size_t at_ = 0;
  const char* kind_;
  std::string name_;
};

/// @return the content of a file  @throws FileError naming kind, path and cause
std::string readBinaryFile(const BinaryFormat& format, const std::string& path);

}  // namespace semantic_vslam
