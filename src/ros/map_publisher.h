// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>
#include <ros/publisher.h>

#include <atomic>
#include <functional>
#include <list>
#include <string>

#include "core/pipeline/dense_stage.h"
#include "ros/map_messages.h"
#include "ros/stage_diagnostics.h"

namespace semantic_vslam {

/// Publishes the dense map: mapping/{semantic_cloud, objects, object_markers}, and what octomap_server publishes, by
/// its names, below mapping/: octomap_binary, octomap_full, octomap_point_cloud_centers, {occupied,
/// free}_cells_vis_array, projected_map. Who subscribes gets the map as it is at the next publication: a latched
/// message might be hours old.
class MapPublisher {
 public:
  /// @param map_frame  frame_id of the maps; its z is up
  MapPublisher(ros::NodeHandle nh, std::string map_frame, const MapObjectsConfig& objects);

  /// The next publish() is to publish. From any thread.
  void ask() { asked_ = true; }
  /// Publishes, if asked and rested, what is watched and has changed, or has a new subscriber. What nobody watches is
  /// not made. One thread.
  void publish(DenseStage& stage);
  /// Adds how large the map was at the last publication, from any thread.
  void report(StageDiagnostics::Status& status) const;

 private:
  using Publish = std::function<void(const ros::Publisher&, MapMessages::State&)>;
  struct Topic {
    Publish publish;
    std::atomic<bool> changed{false};
    ros::Publisher publisher;
  };

  template <class Message>
  void advertise(ros::NodeHandle& nh, const std::string& topic, Publish publish);
  void publishTopics(const DenseMapper& map, const LabelSet& labels);

  const std::string map_frame_;
  MapMessages messages_;
  std::list<Topic> topics_;  // their addresses stay
  std::atomic<bool> asked_{false};
  std::size_t published_ = 0;         // DenseStage::changes() then
  ros::SteadyTime next_publication_;  // not before
  std::atomic<double> taken_s_{0.0};
  std::atomic<std::size_t> keyframes_{0}, voxels_{0}, unplaced_{0}, culled_{0};
};

}  // namespace semantic_vslam
