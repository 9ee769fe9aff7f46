// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <utility>

#include "semantic_vslam/core/common/stamp.h"

namespace semantic_vslam {

/// The newest few values of a stream, found by stamp.
template <class T>
class StampedStore {
 public:
  /// @param disorder_s  by how much a stream's stamps may go back within one recording
  explicit StampedStore(std::size_t capacity, double disorder_s = 0.0) : capacity_(capacity), disorder_s_(disorder_s) {}

  /// Adds or replaces. When full, the oldest goes. A stamp that goes back begins a new recording: all else goes.
  void put(Stamp stamp, T value) {
    if (!values_.empty() && secondsBetween(stamp, values_.rbegin()->first) > disorder_s_) values_.clear();
    values_[stamp] = std::move(value);
    if (values_.size() > capacity_) values_.erase(values_.begin());
  }
  std::optional<T> find(Stamp stamp) const {
    const auto found = values_.find(stamp);
    return found == values_.end() ? std::nullopt : std::optional<T>(found->second);
  }
  bool has(Stamp stamp) const { return values_.count(stamp) > 0; }
  /// Whether a value has come that is newer by the disorder or more, so that this one will not come any more: its
  /// source has passed it over.
  bool passedOver(Stamp stamp) const {
    return !has(stamp) && !values_.empty() && values_.rbegin()->first > stamp &&
           secondsBetween(stamp, values_.rbegin()->first) >= disorder_s_;
  }
  /// How many more seconds it pays to wait for the value of this stamp. @param patience_s  at most, from now
  double worthWaitingS(Stamp stamp, double patience_s) const {
    return has(stamp) || passedOver(stamp) ? 0.0 : patience_s;
  }

 private:
  std::size_t capacity_;
  double disorder_s_;
  std::map<Stamp, T> values_;
};

}  // namespace semantic_vslam
