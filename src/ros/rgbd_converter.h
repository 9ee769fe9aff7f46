// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "core/pipeline/keyframe_inputs.h"
#include "ros/refusals.h"
#include "semantic_vslam/core/camera/rgbd_frame.h"

namespace semantic_vslam {

/// A pair as received. It is converted when a stage asks for it, so that the callbacks return at once.
struct RgbdMessages {
  std::uint64_t index = 0;  ///< counts the pairs received, so that it tells how many were dropped between two
  sensor_msgs::ImageConstPtr rgb, depth;
  sensor_msgs::CameraInfoConstPtr info;  ///< null where a camera file is used
  std::uint32_t recording = 0;           ///< see StampOrder: grows when the clock of a recording goes back
};

/// Turns received pairs into frames of the core, each once for all nodelets of a process: what one has converted the
/// others find as long as any keeps it. Used by many threads.
class RgbdConverter : public std::enable_shared_from_this<RgbdConverter> {
 public:
  /// @throws FileError or ConfigError for a camera file that does not load.
  RgbdConverter(const std::string& camera_file, bool rectified);
  /// The one of this process for a pair of topics. @throws as above
  static std::shared_ptr<RgbdConverter> of(const std::string& topics, const std::string& camera_file, bool rectified);

  /// A frame that is converted when it is asked for, which gives nothing if the pair is unusable (encoding, size,
  /// calibration): counted, and said in the log.
  PendingFrame pending(const RgbdMessages& messages);

  /// Pairs that were worked on; each counts once, whoever asked.
  std::size_t converted() const { return converted_; }
  const Refusals& refusals() const { return refusals_; }
  /// Frames that were taken though they can hardly be what the driver means.
  const Refusals& doubts() const { return doubts_; }

 private:
  struct Conversion;
  std::shared_ptr<Conversion> conversionOf(const RgbdMessages& messages);
  void convert(Conversion& conversion);
  void doubt(const RgbdMessages& messages, const RgbdFrame& frame);
  std::shared_ptr<const CameraModel> cameraFor(const sensor_msgs::CameraInfoConstPtr& info);

  const bool rectified_;
  std::atomic<std::size_t> converted_{0};
  std::atomic<int> without_depth_{0};  // frames in a row
  Refusals refusals_, doubts_;
  std::mutex mutex_;
  std::vector<std::weak_ptr<Conversion>> conversions_;  // guarded by mutex_; of pairs that some nodelet keeps
  std::shared_ptr<const CameraModel> camera_;           // guarded by mutex_, as the next
  sensor_msgs::CameraInfoConstPtr camera_info_;         // what camera_ was made of; null if of a file
};

}  // namespace semantic_vslam
