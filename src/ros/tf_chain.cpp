// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include <tf2_msgs/TFMessage.h>

#include <algorithm>
#include <string>
#include <unordered_map>
#include <vector>

#include "ros/bag_records.h"
#include "ros/bag_source.h"
#include "ros/conversions.h"

namespace semantic_vslam {
namespace {

/// How a frame moves in its parent.
struct Edge {
  std::string parent;
  std::vector<TimedPose> T_parent_child;  // in order of time once sorted
};

using Edges = std::unordered_map<std::string, Edge>;  // by child

/// @note tf2_msgs/TFMessage has the fields and the MD5 sum of the old tf/tfMessage, so this reads both.
Edges readEdges(const rosbag::Bag& bag) {
  Edges edges;
  forEachMessage(bag, {"/tf", "/tf_static"}, [&](const rosbag::MessageInstance& instance) {
    const auto message = instance.instantiate<tf2_msgs::TFMessage>();
    if (!message) return;
    for (const auto& transform : message->transforms) {
      const std::string parent = frameName(transform.header.frame_id);
      Edge& edge = edges[frameName(transform.child_frame_id)];
      if (edge.parent.empty()) edge.parent = parent;
      if (edge.parent != parent) continue;  // a second parent is no tree; the first one counts
      edge.T_parent_child.push_back({fromRos(transform.header.stamp), fromRos(transform.transform)});
    }
  });
  for (auto& [child, edge] : edges) {
    std::stable_sort(edge.T_parent_child.begin(), edge.T_parent_child.end(),
                     [](const TimedPose& a, const TimedPose& b) { return a.stamp < b.stamp; });
  }
  return edges;
}

/// @return edges from the leaf up to the root; empty if they are not connected.
std::vector<const Edge*> chainOf(const Edges& edges, const std::string& root, const std::string& leaf) {
  std::vector<const Edge*> chain;
  for (std::string frame = leaf; frame != root; frame = chain.back()->parent) {
    const auto found = edges.find(frame);
    if (found == edges.end() || chain.size() > edges.size()) return {};  // no parent, or a cycle
    chain.push_back(&found->second);
  }
  return chain;
}

}  // namespace

std::vector<TimedPose> readTfChain(const rosbag::Bag& bag, const std::string& root, const std::string& leaf) {
  const Edges edges = readEdges(bag);
  const std::vector<const Edge*> chain = chainOf(edges, frameName(root), frameName(leaf));
  if (chain.empty()) return {};
  const Edge* most_frequent = *std::max_element(chain.begin(), chain.end(), [](const Edge* a, const Edge* b) {
    return a->T_parent_child.size() < b->T_parent_child.size();
  });
  std::vector<TimedPose> poses;
  for (const TimedPose& sample : most_frequent->T_parent_child) {
    if (!poses.empty() && poses.back().stamp == sample.stamp) continue;
    SE3 T_root_leaf = SE3::Identity();
    for (const Edge* edge : chain) {
      T_root_leaf = closestPose(edge->T_parent_child, sample.stamp)->T_world_camera * T_root_leaf;
    }
    poses.push_back({sample.stamp, T_root_leaf});
  }
  return poses;
}

}  // namespace semantic_vslam
