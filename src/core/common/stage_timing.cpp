// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "semantic_vslam/core/common/stage_timing.h"

#include <time.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <unordered_map>
#include <utility>

#include "core/common/atomic_file.h"

namespace semantic_vslam {

double threadCpuMs() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) * 1e3 + static_cast<double>(now.tv_nsec) * 1e-6;
}

StageTimes::Scope::Scope(StageTimes& times, std::string stage, std::uint64_t frame)
    : times_(times), wall_begin_(std::chrono::steady_clock::now()), cpu_begin_ms_(threadCpuMs()) {
  time_.stage = std::move(stage);
  time_.frame = frame;
}

StageTimes::Scope::~Scope() {
  time_.cpu_ms = threadCpuMs() - cpu_begin_ms_;
  time_.wall_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - wall_begin_).count();
  times_.add(std::move(time_));
}

void StageTimes::add(StageTime time) {
  std::lock_guard<std::mutex> lock(mutex_);
  times_.push_back(std::move(time));
}

void StageTimes::clear() {
  std::lock_guard<std::mutex> lock(mutex_);
  times_.clear();
}

std::vector<StageTime> StageTimes::times() const {
  std::lock_guard<std::mutex> lock(mutex_);
  return times_;
}

std::vector<StageSummary> StageTimes::summarize() const {
  struct Samples {
    std::string stage;
    std::vector<double> wall_ms, cpu_ms;
  };
  std::vector<Samples> stages;
  std::unordered_map<std::string, std::size_t> index_of;
  for (const StageTime& time : times()) {
    const auto [entry, added] = index_of.emplace(time.stage, stages.size());
    if (added) stages.push_back({time.stage, {}, {}});
    stages[entry->second].wall_ms.push_back(time.wall_ms);
    stages[entry->second].cpu_ms.push_back(time.cpu_ms);
  }
  std::vector<StageSummary> summaries;
  for (const Samples& samples : stages) {
    summaries.push_back(
        {samples.stage, samples.wall_ms.size(), quantilesOf(samples.wall_ms), quantilesOf(samples.cpu_ms)});
  }
  return summaries;
}

void StageTimes::writeCsv(const std::string& path) const {
  std::ostringstream out;
  out << "stage,frame,wall_ms,cpu_ms\n" << std::fixed << std::setprecision(3);
  for (const StageTime& time : times()) {
    out << time.stage << ',' << time.frame << ',' << time.wall_ms << ',' << time.cpu_ms << '\n';
  }
  writeTextAtomically(path, out.str());
}

TimeQuantiles quantilesOf(const std::vector<double>& values_ms) {
  return {quantile(values_ms, 0.5), quantile(values_ms, 0.95), *std::max_element(values_ms.begin(), values_ms.end())};
}

double quantile(std::vector<double> values, double q) {
  assert(!values.empty() && q >= 0.0 && q <= 1.0);
  std::sort(values.begin(), values.end());
  const double position = q * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (position - static_cast<double>(below)) * (values[above] - values[below]);
}

}  // namespace semantic_vslam
