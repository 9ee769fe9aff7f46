// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "core/people/mover.h"
#include "core/people/people_config.h"
#include "semantic_vslam/core/camera/rgbd_frame.h"
#include "semantic_vslam/core/geometry/se3.h"

namespace semantic_vslam {

/// The points of a frame that are kept out of the map, on a grid of at most 160 columns. Map frame, metres.
struct DynamicPoints {
  std::vector<Eigen::Vector3f> points;
  std::vector<float> area_m2;         ///< that each stands for, seen from the front
  std::vector<std::uint8_t> person;   ///< 1: labelled as a person
  std::vector<std::uint8_t> at_edge;  ///< 1: at the border of the image, beyond which the body may go on
};

/// @param dynamic       MotionResult::dynamic, of the frame's size, or empty: nothing is
/// @param people        255 where a label says person, of the frame's size, or empty: no labels
/// @param T_map_camera  into a frame with z up
DynamicPoints dynamicPoints(const RgbdFrame& frame, const cv::Mat1b& dynamic, const cv::Mat1b& people,
                            const SE3& T_map_camera, const PeopleConfig& config);

/// Groups points as seen from above (a plan-view map as of Harville 2004): those nearest to one of the places about
/// which most surface stands are one. Who touches another in the image is told apart so, and who is cut in two by a
/// desk stays one.
/// @param camera    position of the camera in the map frame, m
/// @param expected  positions of movers that are followed, see MoverTracker::expected()
std::vector<MoverView> findMovers(const DynamicPoints& dynamic, const Eigen::Vector2d& camera,
                                  const std::vector<Eigen::Vector2d>& expected, const PeopleConfig& config);

}  // namespace semantic_vslam
