// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <ostream>

namespace semantic_vslam {

/// Integer id that cannot be mixed with ids of another kind. Ids grow by one and are never used again.
template <class Tag>
class Id {
 public:
  constexpr Id() = default;
  constexpr explicit Id(std::uint64_t value) : value_(value) {}

  constexpr bool valid() const { return value_ != kInvalid; }
  constexpr std::uint64_t value() const { return value_; }

  friend constexpr bool operator==(Id a, Id b) { return a.value_ == b.value_; }
  friend constexpr bool operator!=(Id a, Id b) { return a.value_ != b.value_; }
  friend constexpr bool operator<(Id a, Id b) { return a.value_ < b.value_; }
  friend std::ostream& operator<<(std::ostream& out, Id id) { return out << id.value_; }

 private:
  static constexpr std::uint64_t kInvalid = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t value_ = kInvalid;
};

using KeyframeId = Id<struct KeyframeTag>;
using LandmarkId = Id<struct LandmarkTag>;

}  // namespace semantic_vslam

namespace std {
template <class Tag>
struct hash<semantic_vslam::Id<Tag>> {
  size_t operator()(semantic_vslam::Id<Tag> id) const { return hash<uint64_t>()(id.value()); }
};
}  // namespace std
