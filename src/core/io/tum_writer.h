// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/io/trajectory.h"
#include "semantic_vslam/core/camera/camera_model.h"

namespace semantic_vslam {

/// One frame of a folder that is written. All images are height x width; mask, labels and pose may be left out.
struct TumFrame {
  Stamp stamp;
  cv::Mat3b bgr;
  cv::Mat1f depth_m;  ///< metres, 0 = none; what 16 bit of 1/5000 m cannot hold (13.1 m) becomes 0
  cv::Mat1b mask;     ///< 255 = moving
  cv::Mat1b labels;   ///< class indices
  std::optional<SE3> T_world_camera;
};

/// Writes a folder in the format of the TUM RGB-D benchmark that TumSequence reads: `rgb/`, `depth/` (16-bit PNG,
/// 1/5000 m), `mask/` and `labels/` (8-bit PNG) with the same names, `rgb.txt`, `depth.txt`, `associations.txt`,
/// `groundtruth.txt`, and `camera.yaml` for loadCameraFile(). The folder appears under its name on finish(); until
/// then, and if that never comes, there is none.
class TumWriter {
 public:
  enum class ColorFormat { kPng, kJpeg95 };

  /// @throws FileError if there already is something of that name or the folder cannot be made.
  TumWriter(const std::string& folder, const CameraIntrinsics& camera, ColorFormat format);
  ~TumWriter();
  TumWriter(const TumWriter&) = delete;
  TumWriter& operator=(const TumWriter&) = delete;

  /// @param frame  later than the frame before (asserted)  @throws FileError, for example when the disk is full.
  void write(const TumFrame& frame);
  /// Writes the lists and gives the folder its name. @throws FileError.
  void finish();

 private:
  std::string folder_, temporary_;
  CameraIntrinsics camera_;
  ColorFormat format_;
  std::vector<Stamp> stamps_;
  std::vector<TimedPose> poses_;
  bool finished_ = false;
};

}  // namespace semantic_vslam
