// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/node_handle.h>

#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "core/runtime/bounded_queue.h"
#include "core/runtime/step_clock.h"
#include "semantic_vslam/core/common/stamp.h"

namespace semantic_vslam {

/// Routes the messages of the core to rosconsole. Once per process is enough; more do no harm.
void installRosLogSink();

/// Where a nodelet's topics, services and parameters are. The callbacks of nh and private_nh come one at a time; those
/// of the others have threads of their own, for what waits.
struct NodeletHandles {
  mutable ros::NodeHandle nh, private_nh, waiting_nh, waiting_private_nh;
  std::string name;
};

/// The health of one nodelet on /diagnostics, once a second: rate, age of the newest result, milliseconds against the
/// budget, queue, and what the nodelet adds.
class StageDiagnostics {
 public:
  using Status = diagnostic_updater::DiagnosticStatusWrapper;

  /// Where the values come from; all called by report().
  struct Sources {
    std::function<QueueCounters()> queue;  ///< of the worker
    std::function<void(Status&)> details;  ///< adds values, may merge a warning
  };

  /// @param budget_ms  wall-clock time that a step may take at the rate the nodelet is meant to keep
  StageDiagnostics(const NodeletHandles& node, const std::string& stage, double budget_ms);

  void setSources(Sources sources) { sources_ = std::move(sources); }
  /// To be called once a second. One call at a time.
  void report() { updater_.force_update(); }

  /// Adds a count of what should not happen; while it grows the status is a warning. To be called by the details.
  /// @param reason  of the last one, where it is known  @return whether it has grown since the last report
  bool addFault(Status& status, const std::string& name, std::size_t count, const std::string& reason = "");

  /// Enters a step of the stage, from any thread.
  void record(Stamp stamp, StepTime time);

 private:
  void fill(Status& status);

  const double budget_ms_;
  Sources sources_;
  std::mutex mutex_;
  std::vector<double> wall_ms_, cpu_ms_;         // guarded by mutex_; of the period since the last report
  Stamp newest_;                                 // guarded by mutex_
  std::size_t steps_ = 0;                        // guarded by mutex_
  std::map<std::string, std::size_t> reported_;  // faults; by report() only
  ros::SteadyTime last_report_;                  // by report() only
  diagnostic_updater::Updater updater_;
};

}  // namespace semantic_vslam
