// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/label_stage.h"

#include <utility>

#include "core/segmentation/segmentation_stage.h"

namespace semantic_vslam {

struct LabelStage::Inside {
  SegmentationStage segmentation;
  SegmentationConfig config;
  std::optional<Stamp> last;  ///< frame that was labelled last
  bool map_exists = false;
};

LabelStage::LabelStage(const SegmentationConfig& config)
    : inside_(new Inside{SegmentationStage(config), config, {}, false}) {}
LabelStage::LabelStage(const SegmentationConfig& config, std::unique_ptr<Segmenter> segmenter)
    : inside_(new Inside{SegmentationStage(config, std::move(segmenter)), config, {}, false}) {}
LabelStage::~LabelStage() = default;
LabelStage::LabelStage(LabelStage&&) noexcept = default;

bool LabelStage::enabled() const { return inside_->segmentation.enabled(); }
const LabelSet& LabelStage::labels() const { return inside_->segmentation.labels(); }

bool LabelStage::isDue(Stamp stamp) const {
  return enabled() && inside_->map_exists && (!inside_->last || inside_->config.labelsAreDue(*inside_->last, stamp));
}

std::optional<FrameLabels> LabelStage::step(const RgbdFrame& frame) {
  if (inside_->last == frame.stamp) return std::nullopt;
  const cv::Mat1b labels = inside_->segmentation.process(frame);
  if (labels.empty()) return std::nullopt;
  inside_->last = frame.stamp;
  return FrameLabels{frame.stamp, labels};
}

void LabelStage::setMapExists(bool exists) { inside_->map_exists = exists; }

}  // namespace semantic_vslam
