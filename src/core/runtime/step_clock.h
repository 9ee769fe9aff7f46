// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>

#include "semantic_vslam/core/common/stage_timing.h"

namespace semantic_vslam {

/// What a step of a stage took.
struct StepTime {
  double wall_ms = 0.0;
  double cpu_ms = 0.0;  ///< of the stage's thread
};

/// Times a step from construction on, on one thread.
class StepClock {
 public:
  StepTime elapsed() const {
    const std::chrono::duration<double, std::milli> wall = std::chrono::steady_clock::now() - begin_;
    return {wall.count(), threadCpuMs() - cpu_begin_ms_};
  }

 private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  double cpu_begin_ms_ = threadCpuMs();
};

}  // namespace semantic_vslam
