// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <std_msgs/Header.h>

#include <functional>
#include <string>
#include <vector>

#include "semantic_vslam/core/dense/dense_mapper.h"
#include "semantic_vslam/core/dense/map_objects.h"
#include "semantic_vslam/core/segmentation/label_set.h"

namespace semantic_vslam {

/// Publishes the dense map, latched: mapping/{semantic_cloud, octomap_binary, octomap_full, projected_map, objects}.
/// One thread makes all calls.
class MapPublisher {
 public:
  /// @param map_frame  frame_id of the maps; its z is up
  MapPublisher(ros::NodeHandle nh, std::string map_frame, const MapObjectsConfig& objects);

  /// The map is newer than what was published.
  void markChanged();
  /// Publishes what has changed and is watched. What nobody watches is not made, but once somebody does.
  void publish(const DenseMapper& map, const LabelSet& labels);

 private:
  struct Topic {
    ros::Publisher publisher;
    bool changed;
    std::function<void(const ros::Publisher&, const std_msgs::Header&, const DenseMapper&, const LabelSet&)> publish;
  };

  const std::string map_frame_;
  std::vector<Topic> topics_;
};

}  // namespace semantic_vslam
