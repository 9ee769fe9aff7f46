// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "semantic_vslam/core/camera/rgbd_frame.h"
#include "semantic_vslam/core/common/ids.h"
#include "semantic_vslam/core/common/label_set.h"
#include "semantic_vslam/core/common/stamp.h"
#include "semantic_vslam/core/dense/dense_config.h"
#include "semantic_vslam/core/dense/dense_result.h"
#include "semantic_vslam/core/geometry/se3.h"

namespace semantic_vslam {

/// What one keyframe adds to the dense map: its static, labelled surface in its own camera frame, so that a loop can
/// move it without computing it again.
struct KeyframeCloud {
  KeyframeId keyframe;
  Stamp stamp;
  std::vector<LabelledPoint> points;
};

/// Pixels of people and moving things: dynamic >= 128 or labelled as a class of Mobility::kPerson.
/// @param labels   indices into label_set, of the frame's size, or empty
/// @param dynamic  probability of motion as in MotionResult, of the frame's size, or empty
/// @return 255 where someone is, else 0, of that size.
cv::Mat1b someonePixels(cv::Size size, const cv::Mat1b& labels, const cv::Mat1b& dynamic, const LabelSet& label_set);

/// Pixels that must not enter the map in any way: people and moving things; what the same surface goes on to beside
/// them, since motion is rarely seen on all of a body; and dynamic_margin_px around.
/// @param depth_m  of the frame, metres, 0 = none
/// @param someone  as someonePixels() gives it, of its size
/// @return 255 where excluded, else 0, of that size.
cv::Mat1b excludedPixels(const cv::Mat1f& depth_m, const cv::Mat1b& someone, const KeyframeCloudConfig& config);

/// Pixels on or beside a depth step that no surface explains: max - min of the valid depths in 3x3 px exceeds
/// 2 z/f tan(max_incidence) + 3 sigma(z), where sigma(z) = depth_noise z^2.
/// @param depth_m  height x width, metres, 0 = none  @param focal_px  focal length
/// @return 255 at edges, else 0, of that size.
cv::Mat1b depthEdges(const cv::Mat1f& depth_m, double focal_px, const KeyframeCloudConfig& config);

/// The static surface that a frame shows, in its camera frame, in the order of the pixels.
/// @param labels    of the frame's size, or empty: then every point has label 0
/// @param excluded  255 where no point may come from (see excludedPixels), of the frame's size, or empty
KeyframeCloud makeKeyframeCloud(KeyframeId id, const RgbdFrame& frame, const cv::Mat1b& labels,
                                const cv::Mat1b& excluded, const KeyframeCloudConfig& config);

/// One point per cube of a grid: mean position and colour, most frequent label.
/// @param cell_m  edge of the cubes  @return points in the order of the cubes
std::vector<LabelledPoint> voxelFilter(const std::vector<LabelledPoint>& points, double cell_m);

}  // namespace semantic_vslam
