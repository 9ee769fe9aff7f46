// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "semantic_vslam/core/common/log.h"

#include <cstdio>
#include <mutex>
#include <utility>

#include "core/common/input_file.h"

namespace semantic_vslam {
namespace {

std::mutex sink_mutex;
LogSink current_sink;  // guarded by sink_mutex

const char* levelName(LogLevel level) {
  switch (level) {
    case LogLevel::kDebug: return "debug";
    case LogLevel::kInfo: return "info";
    case LogLevel::kWarning: return "warning";
    case LogLevel::kError: return "error";
  }
  return "?";
}

}  // namespace

void setLogSink(LogSink sink) {
  std::lock_guard<std::mutex> lock(sink_mutex);
  current_sink = std::move(sink);
}

void log(LogLevel level, const std::string& text) {
  const std::string message = printable(text);
  LogSink sink;
  {
    std::lock_guard<std::mutex> lock(sink_mutex);
    sink = current_sink;
  }
  if (sink) {
    sink(level, message);
  } else if (level != LogLevel::kDebug) {
    std::fprintf(stderr, "%s: %s\n", levelName(level), message.c_str());
  }
}

}  // namespace semantic_vslam
