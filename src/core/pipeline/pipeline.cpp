// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "semantic_vslam/core/pipeline/pipeline.h"

#include <optional>
#include <string>
#include <utility>

#include "core/common/abort_flag.h"
#include "core/dense/dense_mapper.h"
#include "core/pipeline/dense_stage.h"
#include "core/pipeline/keyframe_inputs.h"
#include "core/pipeline/label_stage.h"
#include "core/pipeline/motion_stage.h"
#include "core/pipeline/sparse_slam.h"
#include "core/pipeline/tracking_stage.h"
#include "semantic_vslam/core/common/config_fields.h"
#include "semantic_vslam/core/common/log.h"

namespace semantic_vslam {
namespace {

// k1 is the frame before k2: it is named when k2 fits.
constexpr std::size_t kKeptFrames = 2;

}  // namespace

/// Each rule between the stages stands in one of them; here they are only called, in the order of the paper's figure.
class Pipeline::Stages {
 public:
  Stages(const SystemConfig& config, LabelStage labels);

  StepResult step(const RgbdFrame& frame);
  void finish();
  const SparseSlam& slam() const { return tracking_.slam(); }
  const DenseMapper& dense() const { return dense_.map(); }
  const StageTimes& times() const { return times_; }

 private:
  Running running() const { return {true, labels_.enabled()}; }
  std::optional<MotionResult> findMotion(const RgbdFrame& frame);
  std::optional<FrameLabels> label(const RgbdFrame& frame);
  TrackingOutput track(TrackingInput input);
  void maintain(TrackingOutput& output, const RgbdFrame& frame);
  void map(const KeyframeNotice& keyframe, StepResult& result);
  void map(const KeyframeInputs::Named& named, StepResult& result);
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

Pipeline::Stages::Stages(const SystemConfig& config, LabelStage labels)
    : config_(config),
      motion_(config.motion, config.removal, config.label_delay_s),
      labels_(std::move(labels)),
      tracking_(config.slam, config.waits, config.removal),
      inputs_(config.inputs, kKeptFrames),
      dense_(config.dense, config.removal) {
  validateConfig(config_);
  motion_.take(labels_.labels());
  tracking_.take(labels_.labels());
  dense_.take(labels_.labels());
}

StepResult Pipeline::Stages::step(const RgbdFrame& frame) {
  const bool in_order = tracking_.accepts(frame.stamp, 0, false);
  std::optional<MotionResult> motion = findMotion(frame);
  if (!in_order || !motion) {
    logWarning("frame " + std::to_string(frame.index) + " does not follow the one before by its stamp: passed over");
    return {};
  }
  TrackingInput input{frame, *motion, {}, labels_.enabled()};
  if (tracking_.wantsLabels(input)) input.labels = label(frame);  // k1 must hold no people
  StepResult result{track(std::move(input)), std::move(*motion), {}};
  for (const KeyframeNotice& keyframe : result.keyframes) map(keyframe, result);
  if (labels_.isDue(frame.stamp)) label(frame);
  if (result.place) inputs_.put(*result.place);
  if (const auto between = inputs_.look(frame.stamp, running())) map(*between, result);
  passBack(frame, result);
  return result;
}

/// What moves, by flow and depth and by the labels that have come.
std::optional<MotionResult> Pipeline::Stages::findMotion(const RgbdFrame& frame) {
  auto timer = times_.scope("motion", frame.index);
  return motion_.step(frame);
}

/// Labels of a frame, for the motion stage and the dense map too.
std::optional<FrameLabels> Pipeline::Stages::label(const RgbdFrame& frame) {
  auto timer = times_.scope("segmentation", frame.index);
  std::optional<FrameLabels> labels = labels_.step(frame);
  if (!labels) return std::nullopt;
  inputs_.put(*labels);
  motion_.take(*labels);
  return labels;
}

TrackingOutput Pipeline::Stages::track(TrackingInput input) {
  const RgbdFrame& frame = input.frame;
  input.network_runs = labels_.enabled();  // unless it failed on k1
  inputs_.put(PendingFrame{frame.stamp, 0, [frame] { return frame; }});
  inputs_.put(frame.stamp, input.motion);
  TrackingOutput output;
  {
    auto timer = times_.scope("tracking", frame.index);
    output = tracking_.track(input, tracking_.prepare(input));
  }
  maintain(output, frame);
  return output;
}

/// The map's upkeep, at once.
void Pipeline::Stages::maintain(TrackingOutput& output, const RgbdFrame& frame) {
  const TrackingStage::Alone at_once = [](const std::function<void()>& use) { use(); };
  const AbortFlag never{false};
  for (const KeyframeNotice& keyframe : output.keyframes) {
    if (tracking_.maintain(keyframe.id, frame.index, times_, at_once, never)) {
      tracking_.adjustAll(frame.index, times_, at_once, never);
    }
  }
  output.map = tracking_.snapshot();
}

void Pipeline::Stages::map(const KeyframeNotice& keyframe, StepResult& result) {
  const KeyframeInputs::Named named = inputs_.name(keyframe);
  if (labels_.enabled() && named.frame && !inputs_.hasLabels(keyframe.stamp)) label(*named.frame->decode());
  map(named, result);
}

void Pipeline::Stages::map(const KeyframeInputs::Named& named, StepResult& result) {
  if (!config_.dense.enabled) return;
  const auto gathered = inputs_.gather(named, running());
  const std::optional<KeyframeInput> input = gathered ? decode(*gathered) : std::nullopt;
  if (!input) return;
  auto timer = times_.scope("dense_mapping", input->frame.index);
  result.mapped.push_back({named.keyframe.stamp, dense_.add(*input)});
  dense_.take(*result.map);
}

/// What the stages before tracking learn of the map.
void Pipeline::Stages::passBack(const RgbdFrame& frame, const TrackingOutput& output) {
  if (output.map != passed_back_) {
    passed_back_ = output.map;
    motion_.take(*output.map);
    labels_.setMapExists(output.map->keyframes() > 0);
  }
  if (output.posed()) motion_.take(TimedPose{frame.stamp, output.tracking.T_camera_world.inverse()});
}

void Pipeline::Stages::finish() {
  if (!config_.dense.enabled) return;
  dense_.take(*tracking_.snapshot());
  dense_.map().finish();
}

Pipeline::Pipeline(const SystemConfig& config)
    : stages_(std::make_unique<Stages>(config, LabelStage(config.segmentation))) {}
Pipeline::Pipeline(const SystemConfig& config, std::unique_ptr<Segmenter> segmenter)
    : stages_(std::make_unique<Stages>(config, LabelStage(config.segmentation, std::move(segmenter)))) {}
Pipeline::~Pipeline() = default;

StepResult Pipeline::step(const RgbdFrame& frame) { return stages_->step(frame); }
void Pipeline::finish() { stages_->finish(); }
std::vector<TimedPose> Pipeline::trajectory() const { return slam().trajectory(); }
std::vector<LabelledPoint> Pipeline::cloud() const { return dense().cloud(); }
const StageTimes& Pipeline::times() const { return stages_->times(); }
const SparseSlam& Pipeline::slam() const { return stages_->slam(); }
const DenseMapper& Pipeline::dense() const { return stages_->dense(); }

}  // namespace semantic_vslam
