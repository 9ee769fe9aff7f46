// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/common/rng.h"

namespace semantic_vslam {

/// Damages file contents: flipped bits, numbers that nobody expects, pieces that are missing, doubled, or of another
/// file. The same seed gives the same damage.
class Mutator {
 public:
  explicit Mutator(std::uint64_t seed) : rng_(seed) {}

  /// One to six kinds of damage, one after the other. @param others  contents that pieces may come from
  std::string damaged(std::string content, const std::vector<std::string>& others);
  Rng& rng() { return rng_; }

 private:
  std::size_t below(std::size_t count) { return count == 0 ? 0 : rng_.below(count); }
  void damageOnce(std::string& content, const std::vector<std::string>& others);
  void overwriteNumber(std::string& content);
  void replaceWrittenNumber(std::string& content);

  Rng rng_;
};

}  // namespace semantic_vslam
