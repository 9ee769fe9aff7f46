// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nodelet/nodelet.h>

#include "ros/stage_diagnostics.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {

/// A nodelet that runs one stage. A start that fails is one line in the log and ends the node.
class StageNodelet : public nodelet::Nodelet {
 private:
  virtual void start() = 0;

  /// Ends whatever start() began, all of it or a part, callbacks first. Destructors call it too.
  virtual void stop() = 0;

  void onInit() final {
    installRosLogSink();
    try {
      start();
    } catch (const Error& error) {
      NODELET_FATAL("%s", error.what());
      stop();  // the loader deletes the nodelet after the queues of its callbacks, and they may not outlive these
      throw;   // the loader gives the nodelet up; a node ends
    }
  }
};

}  // namespace semantic_vslam
