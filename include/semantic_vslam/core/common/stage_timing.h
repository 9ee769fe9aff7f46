// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

namespace semantic_vslam {

/// @return CPU time of the calling thread so far
double threadCpuMs();

/// What one stage took for one frame.
struct StageTime {
  std::string stage;
  std::uint64_t frame = 0;
  double wall_ms = 0.0;
  double cpu_ms = 0.0;  ///< of the thread that ran the stage
};

/// How times are spread.
struct TimeQuantiles {
  double median_ms = 0.0;
  double p95_ms = 0.0;
  double worst_ms = 0.0;
};

/// One stage over all its frames.
struct StageSummary {
  std::string stage;
  std::size_t count = 0;
  TimeQuantiles wall, cpu;
};

/// Collects what each stage takes, from any thread.
///
/// CPU time is that of the calling thread (CLOCK_THREAD_CPUTIME_ID). It does not see threads that a library starts for
/// the work, so a program that reports it calls cv::setNumThreads(1) and lets Ceres and ONNX Runtime run on one thread.
class StageTimes {
 public:
  /// Times the block it lives in. Both ends must be on the same thread.
  class Scope {
   public:
    Scope(StageTimes& times, std::string stage, std::uint64_t frame);
    ~Scope();
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    StageTimes& times_;
    StageTime time_;
    std::chrono::steady_clock::time_point wall_begin_;
    double cpu_begin_ms_;
  };

  /// `auto timer = times.scope("motion", frame.index);`
  [[nodiscard]] Scope scope(std::string stage, std::uint64_t frame) { return Scope(*this, std::move(stage), frame); }
  void add(StageTime time);
  void clear();

  /// @return a copy of everything recorded, in the order of recording.
  std::vector<StageTime> times() const;
  /// @return the stages in the order in which they were first recorded.
  std::vector<StageSummary> summarize() const;
  /// Writes `stage,frame,wall_ms,cpu_ms`, one line a record. @throws FileError if the file cannot be written.
  void writeCsv(const std::string& path) const;

 private:
  mutable std::mutex mutex_;
  std::vector<StageTime> times_;  // guarded by mutex_
};

/// Linear interpolation between order statistics. @param values need not be sorted; not empty. @param q in [0, 1].
double quantile(std::vector<double> values, double q);
/// @param values_ms  not empty
TimeQuantiles quantilesOf(const std::vector<double>& values_ms);

}  // namespace semantic_vslam
