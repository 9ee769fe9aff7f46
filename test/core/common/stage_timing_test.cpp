// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "semantic_vslam/core/common/stage_timing.h"

#include <gtest/gtest.h>
#include <time.h>

#include <cstdio>
#include <fstream>
#include <sstream>
#include <thread>

#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

double cpuMs() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) * 1e3 + static_cast<double>(now.tv_nsec) * 1e-6;
}

void burnCpuMs(double duration_ms) {
  const double end_ms = cpuMs() + duration_ms;
  while (cpuMs() < end_ms) {
  }
}

TEST(Quantile, InterpolatesBetweenOrderStatistics) {
  EXPECT_DOUBLE_EQ(quantile({4.0, 1.0, 3.0, 2.0}, 0.5), 2.5);
  EXPECT_DOUBLE_EQ(quantile({7.0}, 0.95), 7.0);
  EXPECT_DOUBLE_EQ(quantile({0.0, 10.0}, 0.95), 9.5);
  EXPECT_DOUBLE_EQ(quantile({3.0, 1.0, 2.0}, 1.0), 3.0);
}

TEST(StageTimes, ScopeMeasuresWorkAsCpuAndWaitingOnlyAsWallTime) {
  StageTimes times;
  {
    auto timer = times.scope("work", 3);
    burnCpuMs(5.0);
  }
  {
    auto timer = times.scope("wait", 4);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  const auto recorded = times.times();
  ASSERT_EQ(recorded.size(), 2U);
  EXPECT_EQ(recorded[0].stage, "work");
  EXPECT_EQ(recorded[0].frame, 3U);
  EXPECT_GE(recorded[0].cpu_ms, 5.0);
  EXPECT_GE(recorded[0].wall_ms, 4.9);
  EXPECT_GE(recorded[1].wall_ms, 20.0);
  EXPECT_LT(recorded[1].cpu_ms, 10.0);
}

TEST(StageTimes, SummarizesEachStageInOrderOfFirstUse) {
  StageTimes times;
  for (std::uint64_t frame = 0; frame < 5; ++frame) {
    times.add({"tracking", frame, 10.0 * static_cast<double>(frame), 1.0});
    times.add({"dense", frame, 2.0, static_cast<double>(frame)});
  }
  const auto summaries = times.summarize();
  ASSERT_EQ(summaries.size(), 2U);
  EXPECT_EQ(summaries[0].stage, "tracking");
  EXPECT_EQ(summaries[0].count, 5U);
  EXPECT_DOUBLE_EQ(summaries[0].wall.median_ms, 20.0);
  EXPECT_DOUBLE_EQ(summaries[0].wall.p95_ms, 38.0);
  EXPECT_DOUBLE_EQ(summaries[0].wall.worst_ms, 40.0);
  EXPECT_DOUBLE_EQ(summaries[1].cpu.median_ms, 2.0);
}

TEST(StageTimes, KeepsRecordsOfSeveralThreads) {
  StageTimes times;
  std::vector<std::thread> workers;
  for (int worker = 0; worker < 4; ++worker) {
    workers.emplace_back([&times] {
      for (std::uint64_t frame = 0; frame < 250; ++frame) auto timer = times.scope("stage", frame);
    });
  }
  for (auto& worker : workers) worker.join();
  EXPECT_EQ(times.times().size(), 1000U);
}

TEST(StageTimes, WritesCsvOrNamesTheFileItCannotWrite) {
  StageTimes times;
  times.add({"motion", 7, 1.5, 1.25});
  const std::string path = testing::TempDir() + "stage_times.csv";
  times.writeCsv(path);
  std::ifstream in(path);
  std::stringstream content;
  content << in.rdbuf();
  EXPECT_EQ(content.str(), "stage,frame,wall_ms,cpu_ms\nmotion,7,1.500,1.250\n");
  std::remove(path.c_str());

  try {
    times.writeCsv("/nonexistent/folder/timing.csv");
    FAIL() << "no error";
  } catch (const FileError& error) {
    EXPECT_NE(std::string(error.what()).find("/nonexistent/folder/timing.csv"), std::string::npos);
  }
}

}  // namespace
}  // namespace semantic_vslam
