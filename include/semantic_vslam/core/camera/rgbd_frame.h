// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <string>

#include "semantic_vslam/core/camera/camera_model.h"
#include "semantic_vslam/core/common/stamp.h"

namespace semantic_vslam {

/// One registered colour and depth image pair. Images are shared and never written to after construction.
struct RgbdFrame {
  std::uint64_t index = 0;  ///< position in the stream, from 0
  Stamp stamp;              ///< of the colour image
  cv::Mat3b bgr;            ///< height x width, 8-bit BGR
  cv::Mat1b gray;           ///< height x width, 8-bit
  cv::Mat1f depth_m;        ///< height x width, metres along z, registered to colour; 0 = none, never NaN or negative
  std::shared_ptr<const CameraModel> camera;
  std::string sensor_frame;  ///< name of the camera's frame of reference; empty where nobody asks
};

/// Checks sizes and types, makes gray, and turns every depth that is NaN, infinite, negative or beyond range into 0.
/// Where there is nothing to change, the frame shares the memory of what is given.
/// @param bgr      8-bit, 1 (gray) or 3 channels (BGR)
/// @param depth    32FC1 in metres or 16UC1 in units of depth_unit_m
/// @param depth_unit_m  metres per unit of a 16UC1 image (REP 118: 0.001; TUM PNG: 0.0002)
/// @throws Error naming what does not fit (size, type, empty).
RgbdFrame makeRgbdFrame(std::uint64_t index, Stamp stamp, const cv::Mat& bgr, const cv::Mat& depth, double depth_unit_m,
                        std::shared_ptr<const CameraModel> camera);

}  // namespace semantic_vslam
