// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "semantic_vslam/core/camera/rgbd_frame.h"
#include "semantic_vslam/core/common/stage_timing.h"
#include "semantic_vslam/core/dense/dense_result.h"
#include "semantic_vslam/core/geometry/timed_pose.h"
#include "semantic_vslam/core/pipeline/config.h"
#include "semantic_vslam/core/pipeline/messages.h"
#include "semantic_vslam/core/segmentation/segmenter.h"

namespace semantic_vslam {

class DenseMapper;
class SparseSlam;

/// The four stages wired by calls: everything of a frame is done within step(), and the same bytes come out for the
/// same bytes in. PipelineRunner wires the same stages on threads, the nodelets by topics.
class Pipeline {
 public:
  /// Opens the network, if one is configured. @throws ConfigError, ModelError
  explicit Pipeline(const SystemConfig& config);
  /// @param segmenter  used in place of the configured network
  Pipeline(const SystemConfig& config, std::unique_ptr<Segmenter> segmenter);
  ~Pipeline();

  /// @param frame  stamps must grow; a frame whose stamp does not is passed over with a warning, but for one that is
  /// older by more than 5 s: the clock was set back, and the trajectory begins anew
  StepResult step(const RgbdFrame& frame);
  /// Brings the dense map to the keyframes' last poses. Call before reading results.
  void finish();

  /// Of all frames whose place in the world is known.
  std::vector<TimedPose> trajectory() const;
  /// The labelled points of the dense map, in the world.
  std::vector<LabelledPoint> cloud() const;
  const StageTimes& times() const;

  // For this repository's own programs, which see their headers.
  const SparseSlam& slam() const;
  const DenseMapper& dense() const;

 private:
  class Stages;
  std::unique_ptr<Stages> stages_;
};

}  // namespace semantic_vslam
