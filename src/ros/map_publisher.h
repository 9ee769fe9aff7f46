// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <std_msgs/Header.h>

#include <atomic>
#include <functional>
#include <list>
#include <optional>
#include <string>
#include <vector>

#include "core/dense/dense_mapper.h"
#include "core/dense/map_objects.h"
#include "semantic_vslam/core/common/label_set.h"

namespace semantic_vslam {

/// Publishes the dense map: mapping/{semantic_cloud, octomap_binary, octomap_full, projected_map, objects}. One thread
/// makes all calls. Who subscribes gets the map as it is at the next publish(): a latched message might be hours old.
class MapPublisher {
 public:
  /// @param map_frame  frame_id of the maps; its z is up
  MapPublisher(ros::NodeHandle nh, std::string map_frame, const MapObjectsConfig& objects);

  /// The map is newer than what was published.
  void markChanged();
  /// Publishes what is watched and has changed, or has a new subscriber. What nobody watches is not made.
  void publish(const DenseMapper& map, const LabelSet& labels);

 private:
  /// The map, with what more than one topic shows of it.
  struct Source {
    const DenseMapper& map;
    const LabelSet& labels;
    std_msgs::Header header;
    std::optional<std::vector<LabelledPoint>> points;

    const std::vector<LabelledPoint>& cloud();
  };
  using Publish = std::function<void(const ros::Publisher&, Source&)>;
  struct Topic {
    Publish publish;
    std::atomic<bool> changed{false};
    ros::Publisher publisher;
  };

  template <class Message>
  void advertise(ros::NodeHandle& nh, const std::string& topic, Publish publish);

  const std::string map_frame_;
  std::list<Topic> topics_;  // their addresses stay
};

}  // namespace semantic_vslam
