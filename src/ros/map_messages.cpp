// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/map_messages.h"

#include <algorithm>
#include <iterator>

#include "ros/conversions.h"
#include "ros/octomap_conversions.h"

namespace semantic_vslam {

using State = MapMessages::State;

const std::vector<MapObject>& State::found() {
  if (!found_) found_ = owner_.findObjects(map_);
  return *found_;
}

sensor_msgs::PointCloud2Ptr State::cloud() { return toRos(map_.surfaceCloud(), header_); }
octomap_msgs::Octomap State::binaryOctomap() { return toRos(map_.binaryOctree(), header_); }
octomap_msgs::Octomap State::fullOctomap() { return toRos(map_.fullOctree(), header_); }
sensor_msgs::PointCloud2Ptr State::centres() { return occupiedCentres(map_.octree(), header_); }

visualization_msgs::MarkerArray State::cells(bool occupied) { return cubeMarkers(map_.octree(), occupied, header_); }

std::optional<nav_msgs::OccupancyGrid> State::grid() {
  // Keyframe poses arrive in the map frame, whose z is up already.
  const OccupancyGrid grid = map_.projectedMap(SE3::Identity());
  if (grid.cells.empty()) return std::nullopt;
  return toRos(grid, header_);
}

ObjectArray State::objects() { return messageOf(found(), labels_, header_); }
visualization_msgs::MarkerArray State::objectMarkers() { return toRos(found(), labels_, header_); }

std::vector<MapObject> MapMessages::findObjects(const DenseMapper& map) {
  std::vector<LabelledPoint> labelled;
  map.surfaceCloud().forEachPart([&](const std::vector<LabelledPoint>& part) {
    std::copy_if(part.begin(), part.end(), std::back_inserter(labelled), [](const auto& p) { return p.label != 0; });
  });
  std::vector<MapObject> objects =
      semantic_vslam::findObjects(labelled, config_, [&](const auto& point) { return map.evidenceAt(point); });
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

}  // namespace semantic_vslam
