// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/io/frame_source.h"
#include "eval/synthetic_room.h"

namespace semantic_vslam {

/// A scenario as a recording that is rendered while it is read, so that nothing is stored.
class ScenarioSource : public FrameSource {
 public:
  /// @throws ConfigError as SyntheticRoom
  ScenarioSource(const Scenario& scenario, const CameraIntrinsics& intrinsics);

  std::optional<RgbdFrame> next() override;
  void skip(std::size_t count) override { next_ += count; }
  std::size_t size() const override { return truth_.size(); }
  std::size_t skippedBroken() const override { return 0; }
  std::shared_ptr<const CameraModel> camera() const override { return camera_; }
  const std::vector<TimedPose>& groundTruth() const override { return truth_; }
  cv::Mat1b groundTruthMask() const override { return mask_; }
  /// All that is true of the frame that next() returned last.
  const SyntheticFrame& rendered() const { return rendered_; }
  const SyntheticRoom& room() const { return room_; }

 private:
  SyntheticRoom room_;
  std::shared_ptr<const CameraModel> camera_;
  std::vector<TimedPose> truth_;
  cv::Mat1b mask_;
  SyntheticFrame rendered_;
  std::size_t next_ = 0;
};

/// Intrinsics of rendered recordings: a Kinect's field of view at any size.
/// @param size  WIDTHxHEIGHT in px, 64x48 to 4096x4096
/// @throws UsageError
CameraIntrinsics syntheticCamera(const std::string& size);

}  // namespace semantic_vslam
