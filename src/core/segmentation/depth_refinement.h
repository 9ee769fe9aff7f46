// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <opencv2/core.hpp>
#include <string>

#include "core/common/rng.h"
#include "core/segmentation/block_grid.h"
#include "core/segmentation/region_growth.h"
#include "semantic_vslam/core/camera/rgbd_frame.h"
#include "semantic_vslam/core/common/label_set.h"
#include "semantic_vslam/core/segmentation/segmentation_config.h"
#include "semantic_vslam/core/segmentation/segmenter.h"

namespace semantic_vslam {

/// Eq. (3): how far apart neighbouring points of an object lie. For each of `samples` random pixels the mean 3-D
/// distance to its 8 neighbours in the mask, the largest and the smallest left out; of those the mean or the median.
/// @param mask      height x width; neighbours count where mask equals mask_id
/// @param pixels    the mask's pixels, row * width + column; `count` of them, at least one
/// @param points_m  3-D point of each of them; z = 0 where none, and such a pixel is no sample and no neighbour
/// @return metres; 0 if no sample has three neighbours
double neighbourDistance(const cv::Mat1i& mask, int mask_id, const int* pixels, std::size_t count,
                         const cv::Mat3f& points_m, int samples, bool median, Rng& rng);

/// Cuts every connected mask back to the object it lies on (the paper's table 1). From the mask's centroid, or the
/// nearest pixel of it with depth, the region grows over 8 neighbours inside the mask while their 3-D distance is below
/// T = epsilon * rho, eq. (4), with rho of eq. (3). What is not reached becomes background. Linear in the image's size.
///
/// Beyond the paper, people are given what the network is in doubt about on their surface (PeopleCompletion), and since
/// masks are not always convex and depth not always whole:
/// - a part that the growth cannot reach (an arm before the body, a person behind a chair's leg) is grown from a seed
///   of its own and stays if it is large and thick enough and about as far away (min_region_share, min_thickness_px,
///   object_depth_m). If the centroid fell on something small, the mask's largest region takes the seed's place;
/// - where the object touches the floor, growth goes on over it and around the object: bands of background along the
///   mask's border are cut (band_px, mask_bands.h);
/// - T holds at the samples' median depth and grows with depth beyond it, as the pixels' own spacing does;
/// - growth visits the middle of every block of stride_px x stride_px; the others stay with theirs unless a step of the
///   depth parts the two. Where a block's middle is not the object's, its other pixels go too: up to half a block;
/// - holes of the depth, and specks of noise at about the object's depth, stay where most of the pixels around them
///   stay; a mask without any depth stays whole.
class DepthRefiner {
 public:
  /// @throws ConfigError if config is out of range.
  explicit DepthRefiner(const RefinementConfig& config);
  ~DepthRefiner();
  DepthRefiner(DepthRefiner&&) noexcept;
  DepthRefiner& operator=(DepthRefiner&&) noexcept;

  /// @param segmentation  indices into label_set; @param frame  of the same size
  /// @return refined labels, same size.
  cv::Mat1b refine(const Segmentation& segmentation, const LabelSet& label_set, const RgbdFrame& frame);

 private:
  cv::Mat1b cut(const cv::Mat1b& labels, const LabelSet& label_set, const RgbdFrame& frame);

  struct Buffers;            // kept between frames: to fetch fresh memory takes as long as the work itself
  RefinementConfig config_;  ///< its lengths and areas are in px of the grid
  std::unique_ptr<Buffers> buffers_;
};

}  // namespace semantic_vslam
