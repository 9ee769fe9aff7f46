// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nav_msgs/OccupancyGrid.h>
#include <octomap_msgs/Octomap.h>
#include <semantic_vslam/ObjectArray.h>
#include <sensor_msgs/PointCloud2.h>
#include <std_msgs/Header.h>
#include <visualization_msgs/MarkerArray.h>

#include <optional>
#include <vector>

#include "core/dense/dense_mapper.h"
#include "core/dense/map_objects.h"

namespace semantic_vslam {

/// The dense map in messages, as MapPublisher sends them. What several of them show is made once a publication; the ids
/// of objects last from one publication to the next. Knows no thread and needs no master.
class MapMessages {
 public:
  explicit MapMessages(const MapObjectsConfig& objects) : config_(objects) {}

  /// One state of the map. It must not change while its messages are made.
  class State {
   public:
    sensor_msgs::PointCloud2Ptr cloud();
    octomap_msgs::Octomap binaryOctomap();
    octomap_msgs::Octomap fullOctomap();
    sensor_msgs::PointCloud2Ptr centres();
    visualization_msgs::MarkerArray cells(bool occupied);
    /// Nothing while there is no cell: a grid of none would shrink a costmap to nothing.
    std::optional<nav_msgs::OccupancyGrid> grid();
    ObjectArray objects();
    visualization_msgs::MarkerArray objectMarkers();

   private:
    friend MapMessages;
    State(MapMessages& owner, const DenseMapper& map, const LabelSet& labels, std_msgs::Header header)
        : owner_(owner), map_(map), labels_(labels), header_(std::move(header)) {}
    const std::vector<MapObject>& found();

    MapMessages& owner_;
    const DenseMapper& map_;
    const LabelSet& labels_;
    const std_msgs::Header header_;
    std::optional<std::vector<MapObject>> found_;
  };
  /// @param header  of the messages; its frame is the map's, whose z is up
  State of(const DenseMapper& map, const LabelSet& labels, std_msgs::Header header) {
    return {*this, map, labels, std::move(header)};
  }

 private:
  std::vector<MapObject> findObjects(const DenseMapper& map);

  const MapObjectsConfig config_;
  ObjectList object_list_;
  std::vector<KeyframePose> object_poses_;  // of the keyframes when the objects were found last
};

}  // namespace semantic_vslam
