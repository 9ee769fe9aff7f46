// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/node_handle.h>

#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "core/runtime/bounded_queue.h"
#include "core/runtime/step_clock.h"
#include "semantic_vslam/core/common/stamp.h"

namespace semantic_vslam {

/// Routes the messages of the core to rosconsole. Once per process is enough; more do no harm.
void installRosLogSink();

/// The health of one nodelet on /diagnostics, once a second: rate, age of the newest result, milliseconds against the
/// budget, queue, and what the nodelet adds.
class StageDiagnostics {
 public:
  using Status = diagnostic_updater::DiagnosticStatusWrapper;

  /// Where the values come from; all called from the callback thread.
  struct Sources {
    std::function<std::string()> missing;  ///< what is wrong with the input; "" if nothing
    std::function<QueueCounters()> queue;  ///< of the worker
    std::function<void(Status&)> details;  ///< adds values, may merge a warning
  };

  /// @param budget_ms  wall-clock time that a step may take at the rate the nodelet is meant to keep
  StageDiagnostics(ros::NodeHandle nh, ros::NodeHandle private_nh, const std::string& node_name,
                   const std::string& stage, double budget_ms);

  /// Begins to report; the sources must stay valid until stop().
  void start(ros::NodeHandle nh, Sources sources);
  /// Returns when no report is under way any more.
  void stop() { timer_.stop(); }

  /// Adds a count of what should not happen; while it grows the status is a warning. To be called by the details.
  /// @return whether it has grown since the last report
  bool addFault(Status& status, const std::string& name, std::size_t count);

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
  std::map<std::string, std::size_t> reported_;  // faults; callback thread only
  ros::SteadyTime last_report_;                  // callback thread only
  diagnostic_updater::Updater updater_;
  ros::SteadyTimer timer_;
};

}  // namespace semantic_vslam
