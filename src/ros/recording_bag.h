// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rosbag/bag.h>

#include <memory>
#include <opencv2/core.hpp>
#include <string>

#include "core/common/atomic_file.h"
#include "semantic_vslam/core/camera/camera_model.h"
#include "semantic_vslam/core/common/stamp.h"
#include "semantic_vslam/core/geometry/se3.h"

namespace semantic_vslam {

/// Writes a bag with the topics, encodings and frame names of the TUM RGB-D benchmark's own bags: colour rgb8, depth
/// 32FC1 in metres with NaN where there is none, camera_info for both, and the true pose on /tf as the chain
/// /world -> /kinect -> /openni_camera -> /openni_rgb_frame -> /openni_rgb_optical_frame.
/// The bag appears under its name on close(); until then, and if that never comes, there is none.
class RecordingBag {
 public:
  /// @throws FileError if the file cannot be made
  RecordingBag(const std::string& path, const CameraIntrinsics& camera, rosbag::CompressionType compression);
  ~RecordingBag();

  /// Each throws FileError, for example when the disk is full.
  void writeColour(Stamp stamp, const cv::Mat3b& bgr);
  /// @param depth_m  metres, 0 = none
  void writeDepth(Stamp stamp, const cv::Mat1f& depth_m);
  /// @param mask  255 = moving
  void writeMask(Stamp stamp, const cv::Mat1b& mask);
  /// @param labels  class indices
  void writeLabels(Stamp stamp, const cv::Mat1b& labels);
  /// To /tf, as the benchmark does.
  void writeTruePose(Stamp stamp, const SE3& T_world_camera);
  /// To /groundtruth/pose.
  void writePoseMessage(Stamp stamp, const SE3& T_world_camera);
  void close();
  const std::string& path() const { return file_.path(); }

 private:
  template <class Message>
  void write(const std::string& topic, Stamp stamp, const Message& message);

  [[noreturn]] void fail(const rosbag::BagException& error);

  AtomicFile file_;
  CameraIntrinsics camera_;
  std::unique_ptr<rosbag::Bag> bag_;
};

}  // namespace semantic_vslam
