// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "semantic_vslam/ros/map_publisher.h"

#include <nav_msgs/OccupancyGrid.h>
#include <octomap_msgs/Octomap.h>
#include <sensor_msgs/PointCloud2.h>
#include <visualization_msgs/MarkerArray.h>

#include <utility>

#include "semantic_vslam/ros/conversions.h"

namespace semantic_vslam {

MapPublisher::MapPublisher(ros::NodeHandle nh, std::string map_frame, const MapObjectsConfig& objects)
    : map_frame_(std::move(map_frame)) {
  using Out = ros::Publisher;
  using Header = std_msgs::Header;
  topics_ = {
      {nh.advertise<sensor_msgs::PointCloud2>("mapping/semantic_cloud", 1, true), false,
       [](const Out& out, const Header& header, const DenseMapper& map, const LabelSet&) {
         out.publish(toRos(map.cloud(), header));
       }},
      {nh.advertise<octomap_msgs::Octomap>("mapping/octomap_binary", 1, true), false,
       [](const Out& out, const Header& header, const DenseMapper& map, const LabelSet&) {
         out.publish(toRos(map.binaryOctree(), header));
       }},
      {nh.advertise<octomap_msgs::Octomap>("mapping/octomap_full", 1, true), false,
       [](const Out& out, const Header& header, const DenseMapper& map, const LabelSet&) {
         out.publish(toRos(map.fullOctree(), header));
       }},
      // Keyframe poses arrive in the map frame, whose z is up already.
      {nh.advertise<nav_msgs::OccupancyGrid>("mapping/projected_map", 1, true), false,
       [](const Out& out, const Header& header, const DenseMapper& map, const LabelSet&) {
         out.publish(toRos(map.projectedMap(SE3::Identity()), header));
       }},
      {nh.advertise<visualization_msgs::MarkerArray>("mapping/objects", 1, true), false,
       [objects](const Out& out, const Header& header, const DenseMapper& map, const LabelSet& labels) {
         out.publish(toRos(findObjects(map.cloud(), objects), labels, header));
       }},
  };
}

void MapPublisher::markChanged() {
  for (Topic& topic : topics_) topic.changed = true;
}

void MapPublisher::publish(const DenseMapper& map, const LabelSet& labels) {
  std_msgs::Header header;
  header.stamp = ros::Time::now();
  header.frame_id = map_frame_;
  for (Topic& topic : topics_) {
    if (!topic.changed || topic.publisher.getNumSubscribers() == 0) continue;
    topic.changed = false;
    topic.publish(topic.publisher, header, map, labels);
  }
}

}  // namespace semantic_vslam
