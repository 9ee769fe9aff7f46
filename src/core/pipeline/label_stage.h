// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>

#include "semantic_vslam/core/camera/rgbd_frame.h"
#include "semantic_vslam/core/common/label_set.h"
#include "semantic_vslam/core/pipeline/messages.h"
#include "semantic_vslam/core/segmentation/segmentation_config.h"
#include "semantic_vslam/core/segmentation/segmenter.h"

namespace semantic_vslam {

/// Stage 3: labels of keyframes, of the frames that tracking asks for to start with, and of one now and then where no
/// keyframes come. Knows no thread.
class LabelStage {
 public:
  /// Opens the network, if one is configured. @throws ConfigError, ModelError
  explicit LabelStage(const SegmentationConfig& config);
  /// @param segmenter  used in place of the configured network; null: no labels
  LabelStage(const SegmentationConfig& config, std::unique_ptr<Segmenter> segmenter);
  ~LabelStage();
  LabelStage(LabelStage&&) noexcept;

  /// Whether there is a network, and it has not failed.
  bool enabled() const;
  const LabelSet& labels() const;

  /// Whether a frame is to be labelled that nobody asked for: a camera that stands still makes no keyframes, and who
  /// then stops in front of it must not be forgotten. Not before there is a map: the first frames are asked for.
  bool isDue(Stamp stamp) const;
  /// @return nothing without a network, when it fails, or if the frame has its labels already
  std::optional<FrameLabels> step(const RgbdFrame& frame);
  void setMapExists(bool exists);

 private:
  struct Inside;
  std::unique_ptr<Inside> inside_;
};

}  // namespace semantic_vslam
