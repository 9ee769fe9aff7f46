// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/map_publisher.h"

#include <nav_msgs/OccupancyGrid.h>
#include <sensor_msgs/PointCloud2.h>

#include <algorithm>
#include <utility>

#include "ros/conversions.h"
#include "ros/octomap_conversions.h"

namespace semantic_vslam {

MapPublisher::MapPublisher(ros::NodeHandle nh, std::string map_frame, const MapObjectsConfig& objects)
    : map_frame_(std::move(map_frame)), objects_(objects) {
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
  advertise<sensor_msgs::PointCloud2>(nh, "mapping/octomap_point_cloud_centers", [](const Out& out, Source& source) {
    out.publish(occupiedCentres(source.octreeLeaves(), source.header));
  });
  for (const bool occupied : {true, false}) {
    const std::string topic = occupied ? "mapping/occupied_cells_vis_array" : "mapping/free_cells_vis_array";
    advertise<visualization_msgs::MarkerArray>(nh, topic, [occupied](const Out& out, Source& source) {
      const double resolution_m = source.map.voxelMap().resolution();
      out.publish(cubeMarkers(source.octreeLeaves(), occupied, resolution_m, source.header));
    });
  }
  // Keyframe poses arrive in the map frame, whose z is up already. A grid without cells would shrink a costmap to
  // nothing.
  advertise<nav_msgs::OccupancyGrid>(nh, "mapping/projected_map", [](const Out& out, Source& source) {
    const OccupancyGrid grid = source.map.projectedMap(SE3::Identity());
    if (!grid.cells.empty()) out.publish(toRos(grid, source.header));
  });
  advertise<ObjectArray>(nh, "mapping/objects", [](const Out& out, Source& source) {
    out.publish(messageOf(source.objects(), source.labels, source.header));
  });
  advertise<visualization_msgs::MarkerArray>(nh, "mapping/object_markers", [](const Out& out, Source& source) {
    out.publish(toRos(source.objects(), source.labels, source.header));
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

const std::vector<OctreeLeaf>& MapPublisher::Source::octreeLeaves() {
  if (!leaves) leaves = map.octreeLeaves();
  return *leaves;
}

const std::vector<MapObject>& MapPublisher::Source::objects() {
  if (!found) found = find_objects(cloud());
  return *found;
}

std::vector<MapObject> MapPublisher::findObjects(const std::vector<LabelledPoint>& cloud, const DenseMapper& map) {
  std::vector<MapObject> objects =
      semantic_vslam::findObjects(cloud, objects_, [&](const auto& point) { return map.evidenceAt(point); });
  const std::vector<KeyframePose> poses = map.poses();
  // A closed loop moves what a keyframe saw with that keyframe.
  object_list_.giveIds(objects, [&](const MapObject& object) {
    const auto was = std::find_if(object_poses_.rbegin(), object_poses_.rend(),
                                  [&](const KeyframePose& pose) { return !(object.last_seen < pose.stamp); });
    if (was == object_poses_.rend()) return SE3(SE3::Identity());
    const auto is = std::find_if(poses.begin(), poses.end(),
                                 [&](const KeyframePose& pose) { return pose.keyframe == was->keyframe; });
    return is == poses.end() ? SE3(SE3::Identity()) : SE3(is->T_world_camera * was->T_world_camera.inverse());
  });
  object_poses_ = poses;
  return objects;
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
  Source source{map, labels, {}, {}, {}, {}, [&](const auto& cloud) { return findObjects(cloud, map); }};
  source.header.stamp = ros::Time::now();
  source.header.frame_id = map_frame_;
  for (Topic& topic : topics_) {
    if (topic.publisher.getNumSubscribers() == 0 || !topic.changed.exchange(false)) continue;
    topic.publish(topic.publisher, source);
  }
}

}  // namespace semantic_vslam
