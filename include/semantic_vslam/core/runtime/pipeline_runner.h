// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

#include "semantic_vslam/core/camera/rgbd_frame.h"
#include "semantic_vslam/core/common/stage_timing.h"
#include "semantic_vslam/core/pipeline/config.h"
#include "semantic_vslam/core/pipeline/messages.h"
#include "semantic_vslam/core/segmentation/segmenter.h"

namespace semantic_vslam {

class DenseMapper;
class SparseSlam;

/// The four stages wired on threads, with the queues and waiting times of the nodelets: takes frames as a camera sends
/// them. Who falls behind loses the oldest frames that wait, never the pace.
class PipelineRunner {
 public:
  /// Called on the tracking thread for every frame that was tracked, in the frames' order.
  using Sink = std::function<void(const RgbdFrame&, const StepResult&)>;

  /// Opens the network, if one is configured. @throws ConfigError, ModelError
  PipelineRunner(const SystemConfig& config, Sink sink);
  /// @param segmenter  used in place of the configured network
  PipelineRunner(const SystemConfig& config, std::unique_ptr<Segmenter> segmenter, Sink sink);
  ~PipelineRunner();

  /// Returns at once. @return false if the sink has failed: no frame is taken any more, and finish() tells why
  bool push(const RgbdFrame& frame);
  /// Returns when nothing of the frames so far is left to do but global bundle adjustment: after it the next frame
  /// finds what Pipeline gives it.
  void settle();
  /// Returns when every frame that was pushed and not dropped has come out of the sink, and the maps are complete. No
  /// push() after it. @throws what the first failing call of the sink threw
  void finish();
  /// Frames that were never tracked.
  std::size_t dropped() const;
  /// Keyframes left out of the dense map for want of labels.
  std::size_t keyframesPassedOver() const;

  // Results; call finish() first.
  const SparseSlam& slam() const;
  const DenseMapper& dense() const;
  const StageTimes& times() const;
  /// Reads the sparse map while the threads run. To be short.
  void read(const std::function<void(const SparseSlam&)>& use) const;

 private:
  class Threads;
  std::unique_ptr<Threads> threads_;
};

}  // namespace semantic_vslam
