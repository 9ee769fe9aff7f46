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
#include "semantic_vslam/core/segmentation/segmenter.h"

namespace semantic_vslam {

struct RefinementConfig {
  bool enabled = true;
  double epsilon = 2.0;
  int samples = 100;
  std::string average = "median";
  int seed = 1;
  int stride_px = 3;
  int min_mask_px = 40;
  int band_px = 12;
  double min_region_share = 0.02;
  double min_thickness_px = 12.0;
  double object_depth_m = 0.5;
  double weak_share = 0.4;

  template <class Visitor>
  void visit(Visitor& v) {
    v.flag("enabled", enabled, "false: the network's masks are used as they are");
    v.field("weak_share", weak_share, 0.0, 1.0,
            "a surface of which this share is a person, and the rest may be one (weak_person), is a person as a whole");
    v.field("epsilon", epsilon, 0.1, 100.0, "eq. (4): growth crosses steps below epsilon times the mask's mean step");
    v.field("samples", samples, 1, 10000, "eq. (3): random pixels of a mask that its mean step is taken from");
    v.choice("average", average, {"mean", "median"},
             "eq. (3) over the samples; the mean is as published, the median ignores samples on the object's edge");
    v.field("seed", seed, 0, 1000000000, "of the random samples");
    v.field("stride_px", stride_px, 1, kMaxBlockStride,
            "regions grow over every so many-th pixel of row and column, and the pixels between go with the one they "
            "are level with; 1: over all, as published, at five times the cost of 3");
    v.field("min_mask_px", min_mask_px, 0, 100000, "smaller connected masks are dropped as noise of the network, px");
    v.field("band_px", band_px, 0, 100,
            "background inside the mask's border is cut up to this width, px: what lies behind a depth edge or in the "
            "plane "
            "outside; 0: only what growth does not reach, as published");
    v.field("min_region_share", min_region_share, 0.0, 1.0,
            "regions of a mask beside the seed's are grown too if they hold this share of it; 1: never, as published");
    v.field("min_thickness_px", min_thickness_px, 0.0, 1000.0,
            "and are this thick on average, px: a mask that is too large leaves a thin band of what lies behind");
    v.field("object_depth_m", object_depth_m, 0.0, 10.0,
            "and if their mean depth lies within this of the seed region's, m: an arm before a body, not the wall; "
            "people stay at any depth, since two who overlap make one mask");
  }
};

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

/// One frame refined by a DepthRefiner of its own.
cv::Mat1b refineOnDepth(const Segmentation& segmentation, const LabelSet& label_set, const RgbdFrame& frame,
                        const RefinementConfig& config);

}  // namespace semantic_vslam
