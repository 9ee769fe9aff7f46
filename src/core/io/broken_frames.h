// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>

namespace semantic_vslam {

/// What a recording does about frames it cannot deliver: a broken image is an accident, reported and skipped; a third
/// of a second of them, or a first frame that does not fit the camera, is a broken recording.
class BrokenFrames {
 public:
  /// @param recording  path, for the messages
  explicit BrokenFrames(std::string recording) : recording_(std::move(recording)) {}

  void countGood();
  /// For an image that cannot be read. @throws FileError at the tenth in a row.
  void countUnreadable(const std::string& reason);
  /// For an image that was read but has a size or type that does not fit. @throws FileError as above, and if no frame
  /// was good before.
  void countMisfit(const std::string& reason);

  /// For the end of the recording. @throws FileError if frames were broken and none was good
  void countEnd() const;

  std::size_t count() const { return broken_; }

 private:
  std::string recording_, last_reason_;
  std::size_t good_ = 0, broken_ = 0, in_a_row_ = 0;
};

}  // namespace semantic_vslam
