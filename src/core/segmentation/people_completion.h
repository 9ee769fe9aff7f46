// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "core/labels/connected_regions.h"
#include "semantic_vslam/core/camera/rgbd_frame.h"

namespace semantic_vslam {

/// Gives people the parts that a network is in doubt about: the rim, an arm, a patterned shirt. Hysteresis, as Canny's
/// edges have it (IEEE PAMI 8, 1986): where a surface without a step in depth may be a person everywhere (weak) and
/// mostly is by the best class (strong), all of it is. What lies behind a depth edge is another surface and stays
/// what it was; so do pixels without depth. Linear in the image's size.
class PeopleCompletion {
 public:
  /// @param stride_px  surfaces are followed over the middle of every block of that many pixels in row and column
  /// @param min_share  strong share of a surface from which on all of it is the person, 0 to 1
  PeopleCompletion(int stride_px, double min_share) : stride_(stride_px), min_share_(min_share) {}

  /// @param labels  get the person's label where weak pixels lie on a person's surface
  /// @param weak_people  not 0: may be a person  @param person  label of people  @param frame  all of one size
  void complete(cv::Mat1b& labels, const cv::Mat1b& weak_people, std::uint8_t person, const RgbdFrame& frame);

 private:
  int stride_;
  double min_share_;
  cv::Mat1b labels_, weak_, taken_;  ///< of the grid, as all here: kept between frames
  cv::Mat1f depth_m_;
  std::vector<cv::Point> candidates_;
  ConnectedRegions surfaces_;
};

}  // namespace semantic_vslam
