// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/map_publisher.h"

#include <utility>

namespace semantic_vslam {

MapPublisher::MapPublisher(ros::NodeHandle nh, std::string map_frame, const MapObjectsConfig& objects)
    : map_frame_(std::move(map_frame)), messages_(objects) {
  using Out = ros::Publisher;
  using Map = MapMessages::State;
  using visualization_msgs::MarkerArray;
  advertise<sensor_msgs::PointCloud2>(nh, "mapping/semantic_cloud",
                                      [](const Out& out, Map& map) { out.publish(map.cloud()); });
  advertise<octomap_msgs::Octomap>(nh, "mapping/octomap_binary",
                                   [](const Out& out, Map& map) { out.publish(map.binaryOctomap()); });
  advertise<octomap_msgs::Octomap>(nh, "mapping/octomap_full",
                                   [](const Out& out, Map& map) { out.publish(map.fullOctomap()); });
  advertise<sensor_msgs::PointCloud2>(nh, "mapping/octomap_point_cloud_centers",
                                      [](const Out& out, Map& map) { out.publish(map.centres()); });
  advertise<MarkerArray>(nh, "mapping/occupied_cells_vis_array",
                         [](const Out& out, Map& map) { out.publish(map.cells(true)); });
  advertise<MarkerArray>(nh, "mapping/free_cells_vis_array",
                         [](const Out& out, Map& map) { out.publish(map.cells(false)); });
  advertise<nav_msgs::OccupancyGrid>(nh, "mapping/projected_map", [](const Out& out, Map& map) {
    if (const auto grid = map.grid()) out.publish(*grid);
  });
  advertise<ObjectArray>(nh, "mapping/objects", [](const Out& out, Map& map) { out.publish(map.objects()); });
  advertise<MarkerArray>(nh, "mapping/object_markers",
                         [](const Out& out, Map& map) { out.publish(map.objectMarkers()); });
}

template <class Message>
void MapPublisher::advertise(ros::NodeHandle& nh, const std::string& topic, Publish publish) {
  Topic& added = topics_.emplace_back();
  added.publish = std::move(publish);
  added.publisher =
      nh.advertise<Message>(topic, 1, [&added](const ros::SingleSubscriberPublisher&) { added.changed = true; });
}

/// A large map takes seconds to publish: three quarters of the time are left to the keyframes that wait.
void MapPublisher::publish(DenseStage& stage) {
  constexpr int kRestPerWork = 3;
  unplaced_ = stage.waiting();
  culled_ = stage.culled();
  const ros::SteadyTime begin = ros::SteadyTime::now();
  if (begin < next_publication_ || !asked_.exchange(false)) return;
  stage.map().work();
  if (std::exchange(published_, stage.changes()) != stage.changes()) {  // during a rebuild the old map is served
    for (Topic& topic : topics_) topic.changed = true;
  }
  keyframes_ = stage.map().keyframes();
  voxels_ = stage.map().voxels();
  publishTopics(stage.map(), stage.labels());
  const ros::WallDuration taken = ros::SteadyTime::now() - begin;
  taken_s_ = taken.toSec();
  next_publication_ = ros::SteadyTime::now() + taken * kRestPerWork;
}

void MapPublisher::report(StageDiagnostics::Status& status) const {
  status.add("keyframes in the map", keyframes_.load());
  status.add("keyframes whose place is not known yet", unplaced_.load());
  status.add("keyframes dropped before they were mapped", culled_.load());
  status.add("voxels", voxels_.load());
  status.addf("last publication", "%.2f s", taken_s_.load());
}

void MapPublisher::publishTopics(const DenseMapper& map, const LabelSet& labels) {
  std_msgs::Header header;
  header.stamp = ros::Time::now();
  header.frame_id = map_frame_;
  MapMessages::State state = messages_.of(map, labels, header);
  for (Topic& topic : topics_) {
    if (topic.publisher.getNumSubscribers() == 0 || !topic.changed.exchange(false)) continue;
    topic.publish(topic.publisher, state);
  }
}

}  // namespace semantic_vslam
