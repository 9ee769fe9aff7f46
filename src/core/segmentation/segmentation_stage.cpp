// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/segmentation/segmentation_stage.h"

#include <string>
#include <utility>

#include "core/segmentation/depth_refinement.h"
#include "core/segmentation/onnx_segmenter.h"
#include "semantic_vslam/core/common/config_fields.h"
#include "semantic_vslam/core/common/error.h"
#include "semantic_vslam/core/common/log.h"

namespace semantic_vslam {
namespace {

std::unique_ptr<Segmenter> openNetwork(const SegmentationConfig& config) {
  if (config.model.empty()) {
    logInfo("no semantic network (segmentation.model is empty): motion detection alone finds what moves");
    return nullptr;
  }
  if (!canRunNetworks() && config.model == SegmentationConfig().model) {  // nobody asked for one of their own
    logWarning("this build has no ONNX Runtime, so no network runs: motion detection alone finds what moves");
    return nullptr;
  }
  return makeOnnxSegmenter(config);
}

}  // namespace

SegmentationStage::SegmentationStage(const SegmentationConfig& config)
    : SegmentationStage(config, openNetwork(config)) {}

SegmentationStage::SegmentationStage(const SegmentationConfig& config, std::unique_ptr<Segmenter> segmenter)
    : segmenter_(std::move(segmenter)), refiner_(config.refinement) {
  validateConfig(config);
  if (segmenter_ != nullptr) labels_ = segmenter_->labels();
}

cv::Mat1b SegmentationStage::process(const RgbdFrame& frame) {
  if (segmenter_ == nullptr) return {};
  try {
    return refiner_.refine(segmenter_->segment(frame.bgr), labels_, frame);
  } catch (const ModelError& error) {
    logError(std::string(error.what()) + "; going on without labels");
    segmenter_.reset();
    return {};
  }
}

}  // namespace semantic_vslam
