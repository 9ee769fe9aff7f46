// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace semantic_vslam {

/// Shows on stderr how far a long work is: one line that is rewritten on a terminal, else a line every ten seconds.
class Progress {
 public:
  /// @param what  is counted, e.g. "frames"
  Progress(std::size_t total, std::string what);
  ~Progress() { end(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// @param details  stands behind the counts
  void show(std::size_t done, const std::string& details = "");
  /// Ends the line, so that other output starts on its own.
  void end();

 private:
  using Clock = std::chrono::steady_clock;

  const std::size_t total_;
  const std::string what_;
  const bool terminal_;
  const Clock::time_point begin_ = Clock::now();
  double last_s_ = 0.0;
  bool line_open_ = false;
};

}  // namespace semantic_vslam
