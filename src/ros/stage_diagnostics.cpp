// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/stage_diagnostics.h"

#include <ros/console.h>

#include <utility>

#include "ros/conversions.h"
#include "semantic_vslam/core/common/log.h"

namespace semantic_vslam {
namespace {

using diagnostic_msgs::DiagnosticStatus;

void addTimes(StageDiagnostics::Status& status, const char* name, const std::vector<double>& times_ms) {
  if (times_ms.empty()) return;
  status.addf(std::string(name) + " median", "%.1f ms", quantile(times_ms, 0.5));
  status.addf(std::string(name) + " worst", "%.1f ms", quantile(times_ms, 1.0));
}

}  // namespace

void installRosLogSink() {
  setLogSink([](LogLevel level, const std::string& message) {
    switch (level) {
      case LogLevel::kDebug: ROS_DEBUG("%s", message.c_str()); break;
      case LogLevel::kInfo: ROS_INFO("%s", message.c_str()); break;
      case LogLevel::kWarning: ROS_WARN("%s", message.c_str()); break;
      case LogLevel::kError: ROS_ERROR("%s", message.c_str()); break;
    }
  });
}

StageDiagnostics::StageDiagnostics(const NodeletHandles& node, const std::string& stage, double budget_ms)
    : budget_ms_(budget_ms), last_report_(ros::SteadyTime::now()), updater_(node.nh, node.private_nh, node.name) {
  updater_.setHardwareID("none");
  updater_.add(stage, [this](Status& status) { fill(status); });
}

void StageDiagnostics::record(Stamp stamp, StepTime time) {
  std::lock_guard<std::mutex> lock(mutex_);
  wall_ms_.push_back(time.wall_ms);
  cpu_ms_.push_back(time.cpu_ms);
  newest_ = stamp;
  ++steps_;
}

bool StageDiagnostics::addFault(Status& status, const std::string& name, std::size_t count, const std::string& reason) {
  status.add(name, count);
  const std::size_t more = count - std::exchange(reported_[name], count);
  if (more > 0) {
    status.mergeSummary(DiagnosticStatus::WARN,
                        name + ": " + std::to_string(more) + " more" + (reason.empty() ? "" : ", the last: " + reason));
  }
  return more > 0;
}

void StageDiagnostics::fill(Status& status) {
  std::vector<double> wall_ms, cpu_ms;
  {
    std::lock_guard<std::mutex> lock(mutex_);
    wall_ms.swap(wall_ms_);
    cpu_ms.swap(cpu_ms_);
    status.add("steps", steps_);
    if (steps_ > 0) status.addf("age of newest", "%.3f s", ros::Time::now().toSec() - newest_.seconds());
  }
  const ros::SteadyTime now = ros::SteadyTime::now();
  status.summary(DiagnosticStatus::OK, wall_ms.empty() ? "waiting" : "running");
  status.addf("rate", "%.1f Hz", static_cast<double>(wall_ms.size()) / (now - last_report_).toSec());
  last_report_ = now;

  addTimes(status, "wall", wall_ms);
  addTimes(status, "cpu", cpu_ms);
  status.addf("budget", "%.1f ms", budget_ms_);
  if (!wall_ms.empty() && quantile(wall_ms, 0.5) > budget_ms_) {
    status.mergeSummary(DiagnosticStatus::WARN, "slower than the budget");
  }

  const QueueCounters queue = sources_.queue();
  status.add("queue high water", queue.high_water);
  addFault(status, "dropped", queue.dropped);
  addFault(status, "steps that failed", queue.failed);

  sources_.details(status);
}

}  // namespace semantic_vslam
