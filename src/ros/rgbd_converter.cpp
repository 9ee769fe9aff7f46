// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/rgbd_converter.h"

#include <ros/console.h>

#include "ros/conversions.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

bool sameCamera(const sensor_msgs::CameraInfo& a, const sensor_msgs::CameraInfo& b) {
  return a.width == b.width && a.height == b.height && a.K == b.K && a.P == b.P && a.D == b.D &&
         a.distortion_model == b.distortion_model;
}

}  // namespace

RgbdConverter::RgbdConverter(const RgbdInputConfig& config) : rectified_(config.rectified) {
  if (!config.camera_file.empty()) camera_ = std::make_shared<CameraModel>(loadCameraFile(config.camera_file));
}

std::shared_ptr<const CameraModel> RgbdConverter::cameraFor(const RgbdMessages& messages) {
  if (!messages.info) return camera_;
  // Making a model costs milliseconds (its table of rays), so a new one is made only when the calibration changes.
  if (!camera_info_ || !sameCamera(*camera_info_, *messages.info)) {
    camera_ = std::make_shared<CameraModel>(fromRos(*messages.info, rectified_));
    camera_info_ = messages.info;
  }
  return camera_;
}

std::optional<RgbdFrame> RgbdConverter::convert(const RgbdMessages& messages) {
  try {
    return makeRgbdFrame(messages.index, fromRos(messages.rgb->header.stamp), colourFromRos(messages.rgb),
                         depthFromRos(messages.depth), kMetresPerMillimetre, cameraFor(messages));
  } catch (const Error& error) {
    ++refused_;
    if (throttle_.passes(error.what())) ROS_ERROR("frame refused: %s", error.what());
    return std::nullopt;
  }
}

PendingFrame RgbdConverter::pending(const RgbdMessages& messages, std_msgs::Header& header) {
  return {fromRos(messages.rgb->header.stamp), messages.recording, [this, messages, &header] {
            header = messages.rgb->header;
            return convert(messages);
          }};
}

}  // namespace semantic_vslam
