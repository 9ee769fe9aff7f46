// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/runtime/monitor.h"

#include <gtest/gtest.h>

#include <future>

namespace semantic_vslam {
namespace {

double until3(int value, double) { return value < 3 ? 600.0 : 0.0; }

TEST(Monitor, WaitEndsWithTheChangeThatIsWaitedFor) {
  Monitor<int> monitor(0);
  auto waiting = std::async(std::launch::async, [&] { monitor.waitWhile(until3); });
  for (int i = 0; i < 3; ++i) monitor.with([](int& value) { ++value; });
  waiting.get();
}

TEST(Monitor, WaitEndsWhenItDoesNotPayAnyMore) {
  Monitor<int> monitor(0);
  monitor.waitWhile([](int, double waited_s) { return 0.01 - waited_s; });
}

TEST(Monitor, CloseWakesWhoWaits) {
  Monitor<int> monitor(0);
  auto waiting = std::async(std::launch::async, [&] { monitor.waitWhile(until3); });
  monitor.close();
  waiting.get();
  monitor.waitWhile(until3);  // nor does anybody wait later
}

}  // namespace
}  // namespace semantic_vslam
