// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "semantic_vslam/core/camera/rgbd_frame.h"
#include "semantic_vslam/core/common/ids.h"
#include "semantic_vslam/core/common/label_set.h"
#include "semantic_vslam/core/common/stamp.h"
#include "semantic_vslam/core/geometry/se3.h"

namespace semantic_vslam {

/// One coloured, labelled point: 16 bytes. In the camera frame in a KeyframeCloud, in the world elsewhere.
struct LabelledPoint {
  cv::Vec3f xyz_m;
  cv::Vec3b bgr;
  std::uint8_t label = 0;
};

/// What one keyframe adds to the dense map: its static, labelled surface in its own camera frame, so that a loop can
/// move it without computing it again.
struct KeyframeCloud {
  KeyframeId keyframe;
  Stamp stamp;
  std::vector<LabelledPoint> points;
};

struct KeyframePose {
  KeyframeId keyframe;
  Stamp stamp;
  SE3 T_world_camera = SE3::Identity();
};

struct KeyframeCloudConfig {
  int stride_px = 2;
  double min_depth_m = 0.3;
  double max_depth_m = 4.0;
  double depth_noise_m_per_m2 = 0.0019;
  double max_incidence_deg = 80.0;
  int dynamic_margin_px = 8;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("stride_px", stride_px, 1, 16,
            "every n-th pixel and row makes a point; 2 px at 2 m are 8 mm, finer than the map's voxels");
    v.field("min_depth_m", min_depth_m, 0.05, 5.0, "nearer depth is dropped: below the range of structured light");
    v.field("max_depth_m", max_depth_m, 0.5, 20.0,
            "farther depth is dropped: its noise grows with z^2 and passes a voxel of 3 cm (1 sigma) at 4 m");
    v.field("depth_noise_m_per_m2", depth_noise_m_per_m2, 0.0001, 0.1,
            "standard deviation of depth over z^2, 1/m; 0.0019 for Kinect v1 (Nguyen et al. 2012)");
    v.field(
        "max_incidence_deg", max_incidence_deg, 30.0, 89.0,
        "a depth step steeper than a plane seen at this angle is an edge; its pixels mix both sides and are dropped");
    v.field("dynamic_margin_px", dynamic_margin_px, 0, 100,
            "dropped around people and moving things: colour and depth are up to 16 ms apart, in which a walker at 2 m "
            "moves 6 px, and depth is wrong along outlines");
  }
};

/// Pixels that must not enter the map in any way: dynamic >= 128 or labelled as a class of Mobility::kPerson, with
/// dynamic_margin_px around.
/// @param size     of the frame
/// @param labels   indices into label_set, of that size, or empty
/// @param dynamic  probability of motion as in MotionResult, of that size, or empty
/// @return 255 where excluded, else 0, of that size.
cv::Mat1b excludedPixels(const cv::Size& size, const cv::Mat1b& labels, const cv::Mat1b& dynamic,
                         const LabelSet& label_set, const KeyframeCloudConfig& config);

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
