// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace semantic_vslam {

/// Lowers the priority of the calling thread, once and for good: for work that may take its time, so that it gives way
/// to what every frame waits for where cores are few.
void lowerThreadPriority();

/// Names the calling thread, as `top -H`, gdb and perf show it. @param name  15 letters at most
void nameThread(const char* name);

}  // namespace semantic_vslam
