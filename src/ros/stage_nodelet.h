// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nodelet/nodelet.h>

#include <exception>
#include <memory>

#include "ros/node_inputs.h"
#include "ros/stage_diagnostics.h"

namespace semantic_vslam {

/// The nodelet of a stage. `Topics` is built of NodeletHandles and is all there is: publishers, then the runner that
/// publishes, then the inputs that feed it. Its members' destructors end them the other way round. A start that fails
/// is one line in the log and ends the node.
template <class Topics>
class StageNodelet final : public nodelet::Nodelet {
 private:
  void onInit() override {
    installRosLogSink();
    try {
      topics_ = std::make_unique<Topics>(NodeletHandles{getNodeHandle(), getPrivateNodeHandle(), getMTNodeHandle(),
                                                        getMTPrivateNodeHandle(), getName()});
    } catch (const std::exception& error) {
      NODELET_FATAL("%s", error.what());
      throw;  // the loader gives the nodelet up; a node ends
    }
  }

  std::unique_ptr<Topics> topics_;
};

}  // namespace semantic_vslam
