// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/tracking_markers.h"

#include "ros/conversions.h"

namespace semantic_vslam {

geometry_msgs::PoseArray toPoseArray(const KeyframePoseArray& keyframes) {
  geometry_msgs::PoseArray poses;
  poses.header = keyframes.header;
  for (const KeyframeStamped& keyframe : keyframes.keyframes) {
    if (keyframe.placed) poses.poses.push_back(toPose(fromRos(keyframe.pose) * bodyFromOptical().inverse()));
  }
  return poses;
}

visualization_msgs::Marker toMarker(const TrackingReport& report, const std::string& state,
                                    const geometry_msgs::Point& camera, const std::string& map_frame) {
  constexpr double kAboveM = 0.25, kLettersM = 0.12;
  visualization_msgs::Marker marker;
  marker.header.stamp = report.header.stamp;
  marker.header.frame_id = map_frame;
  marker.ns = "state";
  marker.type = visualization_msgs::Marker::TEXT_VIEW_FACING;
  marker.pose.position = camera;
  marker.pose.position.z += kAboveM;
  marker.pose.orientation.w = 1.0;
  marker.scale.z = kLettersM;
  marker.color.a = 1.0F;
  const bool ok = report.state == TrackingReport::OK;
  const bool lost = report.state == TrackingReport::LOST || report.state == TrackingReport::INITIALISING;
  marker.color.r = ok ? 0.2F : 1.0F;
  marker.color.g = lost ? 0.2F : 0.9F;
  marker.color.b = 0.2F;
  marker.text = ok ? state + ", " + std::to_string(report.inliers) + " points" : state;
  return marker;
}

}  // namespace semantic_vslam
