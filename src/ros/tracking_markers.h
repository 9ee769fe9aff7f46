// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <geometry_msgs/PoseArray.h>
#include <semantic_vslam/KeyframePoseArray.h>
#include <semantic_vslam/TrackingReport.h>
#include <visualization_msgs/Marker.h>

#include <string>

namespace semantic_vslam {

/// The keyframes whose place in the map is known, as rviz draws poses: x forward, z up.
geometry_msgs::PoseArray toPoseArray(const KeyframePoseArray& keyframes);

/// The state in words, over the camera: green while it has its place, red where it has none, yellow while that is
/// guessed or no image comes.
/// @param camera  where to write it, in the frame `map_frame`
visualization_msgs::Marker toMarker(const TrackingReport& report, const std::string& state,
                                    const geometry_msgs::Point& camera, const std::string& map_frame);

}  // namespace semantic_vslam
