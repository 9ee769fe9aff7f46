// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

#include "semantic_vslam/core/camera/rgbd_frame.h"
#include "semantic_vslam/core/dense/dense_config.h"

namespace semantic_vslam {

/// What a frame's depth says of the space before the camera: small images of an ideal pinhole camera.
///
/// Where a person or a moving thing stands, a cell says nothing of free space: its outline is uncertain, and a ray that
/// slipped past it is worth little. Well within the outline it says how far away someone is.
struct FreeSpaceView {
  static constexpr std::uint16_t kNoReturn = 65535;

  /// How far it saw nothing but air: the nearest of the depths that fell into a cell, less their noise, in millimetres.
  /// 0 = this cell says nothing; kNoReturn = nothing there sent the light back, near or far.
  cv::Mat1w free_mm;  ///< cells; 4 x 4 px each by default
  /// Mean inverse depth of the static surface in a cell, 1/m; 0 where none fills half of it. Below 0: that of someone
  /// who stands there, negated.
  cv::Mat1f inverse_depth;
  double fx_cells = 1, fy_cells = 1, cx_cells = 0, cy_cells = 0;  ///< column = fx x/z + cx, integer at a cell's centre
  double noise_m_per_m2 = 0;                                      ///< sigma(z) = noise z^2 of one depth

  std::size_t bytes() const { return free_mm.total() * sizeof(std::uint16_t) + inverse_depth.total() * sizeof(float); }
};

/// Each depth z counts as z - 3 sigma(z) for free space. Surfaces leave out what makeKeyframeCloud leaves out.
/// @param excluded  255 where the frame must not speak (see excludedPixels), of the frame's size, or empty
/// @param someone  255 where people and moving things are (see someonePixels), of the frame's size, or empty
/// @param cell_px  edge of a cell in px
FreeSpaceView makeFreeSpaceView(const RgbdFrame& frame, const cv::Mat1b& excluded, const cv::Mat1b& someone,
                                const KeyframeCloudConfig& config, int cell_px = 4);

}  // namespace semantic_vslam
