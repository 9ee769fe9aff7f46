// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/map_services.h"

#include <nav_msgs/GetMap.h>
#include <octomap_msgs/BoundingBoxQuery.h>
#include <octomap_msgs/GetOctomap.h>
#include <std_srvs/Empty.h>

#include "core/dense/dense_mapper.h"
#include "ros/conversions.h"
#include "ros/octomap_conversions.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

std_msgs::Header now(const std::string& frame) {
  std_msgs::Header header;
  header.stamp = ros::Time::now();
  header.frame_id = frame;
  return header;
}

Eigen::AlignedBox3d boxOf(const octomap_msgs::BoundingBoxQuery::Request& request) {
  const Eigen::Vector3d min(request.min.x, request.min.y, request.min.z),
      max(request.max.x, request.max.y, request.max.z);
  if (!((min - max).array() <= 0.0).all()) {
    throw Error("min must not be larger than max, in metres of the map frame; nothing is cleared");
  }
  return {min, max};
}

}  // namespace

void offerMapServices(NodeInputs& inputs, DenseRunner& runner, const std::string& map_frame) {
  using octomap_msgs::BoundingBoxQuery;
  using octomap_msgs::GetOctomap;
  inputs.service<GetOctomap>("octomap_binary", [&runner, map_frame](auto&, auto& answer) {
    runner.run([&](DenseStage& stage) { answer.map = toRos(stage.map().binaryOctree(), now(map_frame)); });
  });
  inputs.service<GetOctomap>("octomap_full", [&runner, map_frame](auto&, auto& answer) {
    runner.run([&](DenseStage& stage) { answer.map = toRos(stage.map().fullOctree(), now(map_frame)); });
  });
  inputs.service<nav_msgs::GetMap>("static_map", [&runner, map_frame](auto&, auto& answer) {
    runner.run([&](DenseStage& stage) {
      const OccupancyGrid grid = stage.map().projectedMap(SE3::Identity());
      if (grid.cells.empty()) throw Error("the map has no grid yet: nothing is mapped at the height of the robot");
      answer.map = toRos(grid, now(map_frame));
    });
  });
  inputs.service<BoundingBoxQuery>("clear_bbx", [&runner](auto& request, auto&) {
    runner.run([box_m = boxOf(request)](DenseStage& stage) { stage.clearBox(box_m); });
  });
  inputs.service<std_srvs::Empty>("reset",
                                  [&runner](auto&, auto&) { runner.run([](DenseStage& stage) { stage.clear(); }); });
}

}  // namespace semantic_vslam
