// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/camera/observation_model.h"

namespace semantic_vslam {

PixelMeasurement makeMeasurement(const Eigen::Vector2d& undistorted_px, double depth_m, double sigma_px, double weight,
                                 const VirtualStereo& camera, const SensorConfig& sensor) {
  PixelMeasurement m;
  m.undistorted_px = undistorted_px;
  m.sigma_px = sigma_px;
  m.disparity_px = depth_m > 0.0 && depth_m <= sensor.closeM() ? camera.fx_baseline / depth_m : 0.0;
  m.disparity_sigma_px = sensor.depth_noise.features_m * camera.fx_baseline * sigma_px;
  m.weight = weight;
  return m;
}

}  // namespace semantic_vslam
