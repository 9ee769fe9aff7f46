// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/io/broken_frames.h"

#include "semantic_vslam/core/common/error.h"
#include "semantic_vslam/core/common/log.h"

namespace semantic_vslam {
namespace {

constexpr std::size_t kMaxInARow = 10;

}  // namespace

void BrokenFrames::countGood() {
  ++good_;
  in_a_row_ = 0;
}

void BrokenFrames::countUnreadable(const std::string& reason) {
  ++broken_;
  last_reason_ = reason;
  if (++in_a_row_ == kMaxInARow) {
    throw FileError("'" + recording_ + "': " + std::to_string(kMaxInARow) +
                    " frames in a row cannot be read; the last: " + reason);
  }
  logWarning(reason + "; frame skipped");
}

void BrokenFrames::countMisfit(const std::string& reason) {
  if (good_ == 0) throw FileError(reason);
  countUnreadable(reason);
}

void BrokenFrames::countEnd() const {
  if (good_ > 0 || broken_ == 0) return;
  throw FileError("'" + recording_ + "': none of its frames can be read; the last: " + last_reason_);
}

}  // namespace semantic_vslam
