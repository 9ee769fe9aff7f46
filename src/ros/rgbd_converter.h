// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <std_msgs/Header.h>

#include <atomic>
#include <memory>
#include <optional>

#include "core/pipeline/keyframe_inputs.h"
#include "ros/log_throttle.h"
#include "ros/rgbd_subscriber.h"
#include "semantic_vslam/core/camera/rgbd_frame.h"

namespace semantic_vslam {

/// Turns received pairs into frames of the core. One thread calls convert().
class RgbdConverter {
 public:
  /// @throws FileError or ConfigError for a camera file that does not load.
  explicit RgbdConverter(const RgbdInputConfig& config);

  /// @return nothing if the pair is unusable (encoding, size, calibration): counted, and said in the log, throttled.
  std::optional<RgbdFrame> convert(const RgbdMessages& messages);

  /// The same for a stage to call when it needs the frame. This object must outlive what is returned.
  /// @param header  filled with the colour image's when the frame is decoded
  PendingFrame pending(const RgbdMessages& messages, std_msgs::Header& header);

  std::size_t refused() const { return refused_; }

 private:
  std::shared_ptr<const CameraModel> cameraFor(const RgbdMessages& messages);

  const bool rectified_;
  std::shared_ptr<const CameraModel> camera_;
  sensor_msgs::CameraInfoConstPtr camera_info_;  // what camera_ was made of; null if of a file
  LogThrottle throttle_;
  std::atomic<std::size_t> refused_{0};
};

}  // namespace semantic_vslam
