// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/iteration_callback.h>

#include "core/common/abort_flag.h"

namespace semantic_vslam {

/// Ends a Ceres solve at the next step once a flag is set; the best values so far are kept.
class AbortCallback : public ceres::IterationCallback {
 public:
  explicit AbortCallback(const AbortFlag* abort) : abort_(abort) {}

  bool aborted() const { return abort_ != nullptr && abort_->load(); }
  ceres::CallbackReturnType operator()(const ceres::IterationSummary&) override {
    return aborted() ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }

 private:
  const AbortFlag* abort_;
};

}  // namespace semantic_vslam
