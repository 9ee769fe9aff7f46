// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include "semantic_vslam/core/camera/rgbd_frame.h"

namespace semantic_vslam {

/// How far a frame saw nothing but air: a small depth image of an ideal pinhole camera, in which each cell holds the
/// nearest of the depths that fell into it, less their noise. In millimetres; 0 = this cell says nothing.
///
/// Where a person or a moving thing stands, the cell says nothing: its outline is uncertain, and a ray that slipped
/// past it is worth little.
struct FreeSpaceView {
  cv::Mat1w free_mm;                                              ///< cells; 4 x 4 px each by default
  double fx_cells = 1, fy_cells = 1, cx_cells = 0, cy_cells = 0;  ///< column = fx x/z + cx, integer at a cell's centre
};

/// Each depth z counts as z - 3 sigma(z), sigma(z) = depth_noise z^2.
/// @param excluded  255 where the frame must not speak (see excludedPixels), of the frame's size, or empty
/// @param depth_noise_m_per_m2  1/m  @param cell_px  edge of a cell in px
FreeSpaceView makeFreeSpaceView(const RgbdFrame& frame, const cv::Mat1b& excluded, double depth_noise_m_per_m2,
                                int cell_px = 4);

}  // namespace semantic_vslam
