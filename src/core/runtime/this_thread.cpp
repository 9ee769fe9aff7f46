// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/runtime/this_thread.h"

#include <pthread.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cassert>
#include <cstring>

namespace semantic_vslam {

void lowerThreadPriority() {
  // Each step of nice takes a fifth of a thread's share: 10 leave it a tenth against one that works on frames.
  constexpr int kNice = 10;
  const auto thread = static_cast<id_t>(syscall(SYS_gettid));  // Linux counts nice by thread
  setpriority(PRIO_PROCESS, thread, kNice + getpriority(PRIO_PROCESS, thread));
}

void nameThread(const char* name) {
  assert(std::strlen(name) <= 15);  // Linux takes no longer one
  pthread_setname_np(pthread_self(), name);
}

}  // namespace semantic_vslam
