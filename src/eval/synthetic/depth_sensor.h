// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

namespace semantic_vslam::synthetic {

/// What a structured-light camera makes of true depth, and a CMOS sensor of true colour.
struct SensorModel {
  bool depth_noise = true;
  bool depth_range = true;  ///< holes outside min_depth_m .. max_depth_m
  bool depth_holes = true;  ///< projector shadows and dropouts
  double min_depth_m = 0.4, max_depth_m = 5.0;
  double baseline_m = 0.075;     ///< projector to camera, Kinect
  double dropout_share = 0.004;  ///< of single pixels
  double edge_jitter_px = 0.5;   ///< sigma of the place on the image that a depth belongs to
  double color_noise = 1.8;      ///< sigma, of 255
  double blur_px = 0.5;          ///< sigma of the lens
};

/// Standard deviation of Kinect depth along z (Nguyen et al. 2012, axial noise). @param depth_m, result: metres
inline double kinectSigma(double depth_m) { return 0.0012 + 0.0019 * (depth_m - 0.4) * (depth_m - 0.4); }

/// @param true_depth_m  0 = nothing there  @param focal_px of the camera  @param seed one a frame; same seed, same
/// noise
/// @return metres, 0 = hole
cv::Mat1f senseDepth(const cv::Mat1f& true_depth_m, double focal_px, const SensorModel& model, std::uint64_t seed);

cv::Mat3b senseColor(const cv::Mat3b& true_bgr, const SensorModel& model, std::uint64_t seed);

}  // namespace semantic_vslam::synthetic
