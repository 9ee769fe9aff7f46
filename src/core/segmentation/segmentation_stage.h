// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <opencv2/core.hpp>

#include "core/segmentation/depth_refinement.h"
#include "semantic_vslam/core/camera/rgbd_frame.h"
#include "semantic_vslam/core/segmentation/segmentation_config.h"
#include "semantic_vslam/core/segmentation/segmenter.h"

namespace semantic_vslam {

/// Labels of a frame, cut to the objects' depth edges. Not thread-safe: one caller at a time.
class SegmentationStage {
 public:
  /// Opens config.model; with no model there are no labels, said once in the log.
  /// @throws ConfigError if config is out of range; ModelError if the network does not load or fit.
  explicit SegmentationStage(const SegmentationConfig& config);
  /// @param segmenter  used in place of config.model; null: no labels
  SegmentationStage(const SegmentationConfig& config, std::unique_ptr<Segmenter> segmenter);

  /// Whether there is a network, and it has not failed.
  bool enabled() const { return segmenter_ != nullptr; }
  /// "background" alone without a network.
  const LabelSet& labels() const { return labels_; }
  /// @return refined label image of the frame's size, indices into labels(); empty without a network. A network that
  /// fails at run time is reported in the log once and not asked again: the SLAM goes on without labels.
  cv::Mat1b process(const RgbdFrame& frame);

 private:
  std::unique_ptr<Segmenter> segmenter_;
  DepthRefiner refiner_;
  LabelSet labels_;
};

}  // namespace semantic_vslam
