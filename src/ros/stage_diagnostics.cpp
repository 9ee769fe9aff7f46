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

StageDiagnostics::StageDiagnostics(ros::NodeHandle nh, ros::NodeHandle private_nh, const std::string& node_name,
                                   const std::string& stage, double budget_ms)
    : budget_ms_(budget_ms), last_report_(ros::SteadyTime::now()), updater_(nh, private_nh, node_name) {
  updater_.setHardwareID("none");
  updater_.add(stage, [this](Status& status) { fill(status); });
}

void StageDiagnostics::start(ros::NodeHandle nh, Sources sources) {
  sources_ = std::move(sources);
  // By the steady clock: with a simulated one that stands still, update() would say nothing.
  timer_ =
      nh.createSteadyTimer(ros::WallDuration(1.0), [this](const ros::SteadyTimerEvent&) { updater_.force_update(); });
}

void StageDiagnostics::record(Stamp stamp, StepTime time) {
  std::lock_guard<std::mutex> lock(mutex_);
  wall_ms_.push_back(time.wall_ms);
  cpu_ms_.push_back(time.cpu_ms);
  newest_ = stamp;
  ++steps_;
}

bool StageDiagnostics::addFault(Status& status, const std::string& name, std::size_t count) {
  status.add(name, count);
  const std::size_t more = count - std::exchange(reported_[name], count);
  if (more > 0) status.mergeSummary(DiagnosticStatus::WARN, name + ": " + std::to_string(more) + " more");
  return more > 0;
}

void StageDiagnostics::fill(Status& status) {
  std::vector<double> wall_ms, cpu_ms;
  {
    std::lock_guard<std::mutex> lock(mutex_);
    wall_ms.swap(wall_ms_);
    cpu_ms.swap(cpu_ms_);
    status.add("steps", steps_);
    if (steps_ > 0) status.addf("age of newest", "%.3f s", (ros::Time::now() - toRos(newest_)).toSec());
  }
  const ros::SteadyTime now = ros::SteadyTime::now();
  status.summary(DiagnosticStatus::OK, "running");
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

  const std::string missing = sources_.missing();
  if (!missing.empty()) status.mergeSummary(DiagnosticStatus::ERROR, missing);
  if (sources_.details) sources_.details(status);
}

}  // namespace semantic_vslam
