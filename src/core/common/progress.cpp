// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/common/progress.h"

#include <unistd.h>

#include <cstdio>
#include <utility>

namespace semantic_vslam {

Progress::Progress(std::size_t total, std::string what)
    : total_(total), what_(std::move(what)), terminal_(isatty(STDERR_FILENO) != 0) {}

void Progress::show(std::size_t done, const std::string& details) {
  const double elapsed_s = std::chrono::duration<double>(Clock::now() - begin_).count();
  const bool due = elapsed_s - last_s_ > (terminal_ ? 0.2 : 10.0);
  if (!due && !(terminal_ && done == total_)) return;
  last_s_ = elapsed_s;
  constexpr const char* kClearToEnd = "\x1b[K";
  std::fprintf(stderr, "%s%zu/%zu %s, %.1f a second%s%s%s", terminal_ ? "\r" : "", done, total_, what_.c_str(),
               static_cast<double>(done) / elapsed_s, details.empty() ? "" : ", ", details.c_str(),
               terminal_ ? kClearToEnd : "\n");
  line_open_ = terminal_;
}

void Progress::end() {
  if (line_open_) std::fputc('\n', stderr);
  line_open_ = false;
}

}  // namespace semantic_vslam
