// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "semantic_vslam/core/camera/rgbd_frame.h"
#include "semantic_vslam/core/geometry/timed_pose.h"

namespace semantic_vslam {

/// A recording that is read frame by frame: a TUM folder or a bag. What makes the whole recording useless (missing,
/// truncated, of the wrong format) throws FileError from the constructor; one broken image is reported and skipped.
class FrameSource {
 public:
  virtual ~FrameSource() = default;

  /// @return the next frame in order of time; its index is its position in the recording. Nothing at the end.
  /// @throws FileError if the first frame does not fit the camera, or too many in a row, or all, cannot be read.
  virtual std::optional<RgbdFrame> next() = 0;
  /// Passes over frames without decoding them.
  virtual void skip(std::size_t count) = 0;
  /// @return number of frames, broken ones included; 0 = unknown.
  virtual std::size_t size() const = 0;
  /// @return frames left out by next() so far because an image could not be read.
  virtual std::size_t skippedBroken() const = 0;
  virtual std::shared_ptr<const CameraModel> camera() const = 0;
  /// @return true poses in order of time; empty if the recording has none.
  virtual const std::vector<TimedPose>& groundTruth() const = 0;
  /// True mask of what moves in the frame that next() returned last.
  /// @return height x width, 255 = moving; empty if the recording has none for it.
  virtual cv::Mat1b groundTruthMask() const = 0;
};

}  // namespace semantic_vslam
