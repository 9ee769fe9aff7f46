// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <opencv2/core.hpp>

#include "core/features/frame_features.h"
#include "semantic_vslam/core/camera/rgbd_frame.h"
#include "semantic_vslam/core/features/features_config.h"

namespace semantic_vslam {

/// ORB features (Rublee et al. 2011) spread evenly over the image and over the pyramid's 8 levels of scale 1.2.
class OrbExtractor {
 public:
  /// @throws ConfigError
  explicit OrbExtractor(const OrbConfig& config);
  ~OrbExtractor();

  /// @param frame    gray, depth and camera are used
  /// @param dynamic  height x width, probability that a pixel moves, 0..255; empty = all static. Features where it is
  ///                 >= 128 are dropped, the others carry the weight 1 - dynamic / 255.
  /// @return features with undistorted position and depth; fewer than asked where the image has no texture.
  FrameFeatures extract(const RgbdFrame& frame, const cv::Mat1b& dynamic) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace semantic_vslam
