// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <opencv2/core.hpp>

#include "core/features/frame_features.h"
#include "semantic_vslam/core/camera/rgbd_frame.h"

namespace semantic_vslam {

struct OrbConfig {
  int features = 1000;
  int fast_threshold = 30;  // FAST takes as long as there are corners; at 20 five in six are thrown away again
  int fast_threshold_low = 7;
  int cell_px = 32;
  int minimum_static = 200;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("features", features, 100, 5000, "features kept per frame; 1000 is the ORB-SLAM2 setting for 640x480");
    v.field("fast_threshold", fast_threshold, 5, 100, "grey levels a FAST corner must differ by");
    v.field("fast_threshold_low", fast_threshold_low, 2, 100, "the same in cells where the first finds nothing");
    v.field("cell_px", cell_px, 16, 128, "side of a detection cell in px of its pyramid level");
    v.field("minimum_static", minimum_static, 0, 2000,
            "with fewer features outside the dynamic mask, the least dynamic ones inside it are kept with low weight");
  }
};

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
