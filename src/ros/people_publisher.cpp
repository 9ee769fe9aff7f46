// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/people_publisher.h"

#include <semantic_vslam/MoverArray.h>
#include <sensor_msgs/PointCloud2.h>
#include <visualization_msgs/MarkerArray.h>

#include <algorithm>
#include <vector>

#include "ros/conversions.h"

namespace semantic_vslam {
namespace {

constexpr double kArrowS = 1.0;  // an arrow leads to where somebody is in that time

Mover toMessage(const TrackedMover& mover) {
  Mover message;
  message.id = mover.id;
  message.label = mover.person ? "person" : "unknown";
  message.last_seen = toRos(mover.last_seen);
  message.pose.pose.position.x = mover.position.x();
  message.pose.pose.position.y = mover.position.y();
  message.pose.pose.position.z = (mover.bottom_m + mover.top_m) / 2;
  message.pose.pose.orientation.w = 1.0;
  message.twist.twist.linear.x = mover.velocity.x();
  message.twist.twist.linear.y = mover.velocity.y();
  message.size.x = message.size.y = mover.width_m;
  message.size.z = mover.top_m - mover.bottom_m;
  for (int row = 0; row < 2; ++row) {
    for (int column = 0; column < 2; ++column) {
      message.pose.covariance[6 * row + column] = mover.covariance(row, column);
      message.twist.covariance[6 * row + column] = mover.covariance(2 + row, 2 + column);
    }
  }
  return message;
}

visualization_msgs::MarkerArray toMarkers(const MoverArray& movers) {
  using visualization_msgs::Marker;
  visualization_msgs::MarkerArray array;
  Marker marker;
  marker.header = movers.header;
  marker.action = Marker::DELETEALL;
  array.markers.push_back(marker);
  marker.action = Marker::ADD;
  marker.pose.orientation.w = 1.0;
  for (const Mover& mover : movers.movers) {
    const bool person = mover.label == "person";
    marker.color.r = person ? 0.86F : 0.9F, marker.color.g = person ? 0.08F : 0.6F,
    marker.color.b = person ? 0.24F : 0.0F;
    marker.id = static_cast<int>(mover.id);
    marker.ns = "bodies";
    marker.type = Marker::CYLINDER;
    marker.color.a = 0.5F;
    marker.pose.position = mover.pose.pose.position;
    marker.scale.x = marker.scale.y = std::max(0.1, mover.size.x);
    marker.scale.z = std::max(0.1, mover.size.z);
    array.markers.push_back(marker);
    marker.ns = "velocities";
    marker.type = Marker::ARROW;
    marker.color.a = 1.0F;
    marker.points = {mover.pose.pose.position, mover.pose.pose.position};
    marker.points[1].x += kArrowS * mover.twist.twist.linear.x;
    marker.points[1].y += kArrowS * mover.twist.twist.linear.y;
    marker.pose.position = geometry_msgs::Point();
    marker.scale.x = 0.04, marker.scale.y = 0.08, marker.scale.z = 0.0;
    array.markers.push_back(marker);
    marker.points.clear();
  }
  return array;
}

}  // namespace

PeoplePublisher::PeoplePublisher(ros::NodeHandle nh, const PeopleConfig& config, const std::string& map_frame)
    : config_(config),
      map_frame_(map_frame),
      tracker_(config),
      people_(nh.advertise<MoverArray>("people", 5)),
      markers_(nh.advertise<visualization_msgs::MarkerArray>("people_markers", 1)),
      cloud_(nh.advertise<sensor_msgs::PointCloud2>("dynamic_cloud", 1)) {}

void PeoplePublisher::publish(const std_msgs::Header& image, const RgbdFrame& frame, const cv::Mat1b& dynamic,
                              const SE3& T_map_camera) {
  const bool people = people_.getNumSubscribers() > 0 || markers_.getNumSubscribers() > 0;
  const bool cloud = cloud_.getNumSubscribers() > 0;
  if (!people) tracker_.clear();
  if (dynamic.empty() || (!people && !cloud)) return;
  std_msgs::Header header = image;
  header.frame_id = map_frame_;
  const DynamicPoints points = dynamicPoints(frame, dynamic, {}, T_map_camera, config_);
  if (cloud) cloud_.publish(toRos(points.points, header));
  if (!people) return;
  MoverArray movers;
  movers.header = header;
  const std::vector<MoverView> views =
      findMovers(points, T_map_camera.translation().head<2>(), tracker_.expected(frame.stamp), config_);
  for (const TrackedMover& mover : tracker_.update(views, frame.stamp)) movers.movers.push_back(toMessage(mover));
  people_.publish(movers);
  if (markers_.getNumSubscribers() > 0) markers_.publish(toMarkers(movers));
}

}  // namespace semantic_vslam
