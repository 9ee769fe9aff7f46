// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "semantic_vslam/core/dense/dense_result.h"
#include "semantic_vslam/core/geometry/timed_pose.h"
#include "semantic_vslam/core/pipeline/config.h"
#include "semantic_vslam/core/pipeline/dense_stage.h"
#include "semantic_vslam/core/pipeline/label_stage.h"
#include "semantic_vslam/core/pipeline/motion_stage.h"
#include "semantic_vslam/core/pipeline/step_result.h"

namespace semantic_vslam {

/// The four stages wired by calls: everything of a frame is done within step(), and the same bytes come out for the
/// same bytes in. PipelineRunner wires the same stages on threads, the nodelets by topics.
class Pipeline {
 public:
  /// Opens the network, if one is configured. @throws ConfigError, ModelError
  explicit Pipeline(const SystemConfig& config);
  /// @param segmenter  used in place of the configured network
  Pipeline(const SystemConfig& config, std::unique_ptr<Segmenter> segmenter);

  /// @param frame  stamps must grow; a frame whose stamp does not is passed over with a warning
  StepResult step(const RgbdFrame& frame);
  /// Brings the dense map to the keyframes' last poses. Call before reading results.
  void finish();

  /// Of all frames whose place in the world is known.
  std::vector<TimedPose> trajectory() const;
  /// The labelled points of the dense map, in the world.
  std::vector<LabelledPoint> cloud() const;
  const SparseSlam& slam() const { return tracking_.slam(); }
  const DenseMapper& dense() const { return dense_.map(); }
  const LabelSet& labels() const { return labels_.labels(); }
  const StageTimes& times() const { return times_; }

 private:
  Pipeline(const SystemConfig& config, LabelStage labels);

  std::optional<MotionResult> findMotion(const RgbdFrame& frame);
  std::optional<FrameLabels> label(const RgbdFrame& frame);
  TrackingOutput track(TrackingInput input);
  void maintain(TrackingOutput& output, const RgbdFrame& frame);
  void map(const KeyframeNotice& keyframe, StepResult& result);
  void passBack(const RgbdFrame& frame, const TrackingOutput& output);

  const SystemConfig config_;
  StageTimes times_;
  MotionStage motion_;
  LabelStage labels_;
  TrackingStage tracking_;
  KeyframeInputs inputs_;
  DenseStage dense_;
  std::shared_ptr<const MapSnapshot> passed_back_;
};

}  // namespace semantic_vslam
