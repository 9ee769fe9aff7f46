// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/map_publisher.h"

#include <nav_msgs/OccupancyGrid.h>
#include <octomap_msgs/Octomap.h>
#include <sensor_msgs/PointCloud2.h>
#include <visualization_msgs/MarkerArray.h>

#include <utility>

#include "ros/conversions.h"

namespace semantic_vslam {

MapPublisher::MapPublisher(ros::NodeHandle nh, std::string map_frame, const MapObjectsConfig& objects)
    : map_frame_(std::move(map_frame)) {
  using Out = ros::Publisher;
  advertise<sensor_msgs::PointCloud2>(nh, "mapping/semantic_cloud", [](const Out& out, Source& source) {
    out.publish(toRos(source.cloud(), source.header));
  });
  advertise<octomap_msgs::Octomap>(nh, "mapping/octomap_binary", [](const Out& out, Source& source) {
    out.publish(toRos(source.map.binaryOctree(), source.header));
  });
  advertise<octomap_msgs::Octomap>(nh, "mapping/octomap_full", [](const Out& out, Source& source) {
    out.publish(toRos(source.map.fullOctree(), source.header));
  });
  // Keyframe poses arrive in the map frame, whose z is up already.
  advertise<nav_msgs::OccupancyGrid>(nh, "mapping/projected_map", [](const Out& out, Source& source) {
    out.publish(toRos(source.map.projectedMap(SE3::Identity()), source.header));
  });
  advertise<visualization_msgs::MarkerArray>(nh, "mapping/objects", [objects](const Out& out, Source& source) {
    out.publish(toRos(findObjects(source.cloud(), objects), source.labels, source.header));
  });
}

template <class Message>
void MapPublisher::advertise(ros::NodeHandle& nh, const std::string& topic, Publish publish) {
  Topic& added = topics_.emplace_back();
  added.publish = std::move(publish);
  added.publisher =
      nh.advertise<Message>(topic, 1, [&added](const ros::SingleSubscriberPublisher&) { added.changed = true; });
}

const std::vector<LabelledPoint>& MapPublisher::Source::cloud() {
  if (!points) points = map.cloud();
  return *points;
}

void MapPublisher::markChanged() {
  for (Topic& topic : topics_) topic.changed = true;
}

void MapPublisher::publish(const DenseMapper& map, const LabelSet& labels) {
  Source source{map, labels, {}, {}};
  source.header.stamp = ros::Time::now();
  source.header.frame_id = map_frame_;
  for (Topic& topic : topics_) {
    if (topic.publisher.getNumSubscribers() == 0 || !topic.changed.exchange(false)) continue;
    topic.publish(topic.publisher, source);
  }
}

}  // namespace semantic_vslam
