// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

namespace semantic_vslam {

enum class LogLevel { kDebug, kInfo, kWarning, kError };

/// Where the core's messages go: stderr by default, rosconsole in the nodelets. The sink is called from any thread.
using LogSink = std::function<void(LogLevel, const std::string&)>;

/// Replaces the process-wide sink; an empty function restores stderr.
void setLogSink(LogSink sink);

void log(LogLevel level, const std::string& message);
inline void logInfo(const std::string& message) { log(LogLevel::kInfo, message); }
inline void logWarning(const std::string& message) { log(LogLevel::kWarning, message); }
inline void logError(const std::string& message) { log(LogLevel::kError, message); }

}  // namespace semantic_vslam
