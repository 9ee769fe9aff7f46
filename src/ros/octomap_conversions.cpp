// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/octomap_conversions.h"

#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "ros/conversions.h"

namespace semantic_vslam {
namespace {

constexpr std::size_t kSizes = 17;  // an octree of OctoMap has 16 levels below its root

std_msgs::ColorRGBA colorOf(const OctreeStream::Leaf& leaf) {
  std_msgs::ColorRGBA color;
  if (leaf.occupied()) {
    color.r = static_cast<float>(leaf.rgb[0]) / 255.0F;
    color.g = static_cast<float>(leaf.rgb[1]) / 255.0F;
    color.b = static_cast<float>(leaf.rgb[2]) / 255.0F;
    color.a = 1.0F;
  } else {
    color.g = 1.0F;
    color.a = 0.15F;  // one looks through free space
  }
  return color;
}

}  // namespace

octomap_msgs::Octomap toRos(OctreeMessage octree, const std_msgs::Header& header) {
  octomap_msgs::Octomap message;
  message.header = header;
  message.binary = octree.binary;
  message.id = std::move(octree.id);
  message.resolution = octree.resolution_m;
  message.data = std::move(octree.data);
  return message;
}

sensor_msgs::PointCloud2Ptr occupiedCentres(const OctreeStream& tree, const std_msgs::Header& header) {
  std::vector<Eigen::Vector3f> centres;
  tree.forEachLeaf([&](const OctreeStream::Leaf& leaf) {
    if (leaf.occupied()) centres.emplace_back((leaf.centre() * tree.resolution()).cast<float>());
  });
  return toRos(centres, header);
}

visualization_msgs::MarkerArray cubeMarkers(const OctreeStream& tree, bool occupied, const std_msgs::Header& header) {
  using visualization_msgs::Marker;
  std::array<std::size_t, kSizes> count{};
  const auto sizeOf = [](const OctreeStream::Leaf& leaf) {  // 0 for a voxel
    std::size_t size = 0;
    while (leaf.side >> size > 1) ++size;
    return size;
  };
  tree.forEachLeaf([&](const OctreeStream::Leaf& leaf) {
    if (leaf.occupied() == occupied) ++count.at(sizeOf(leaf));
  });
  visualization_msgs::MarkerArray array;
  array.markers.resize(kSizes);
  for (std::size_t size = 0; size < kSizes; ++size) {
    Marker& marker = array.markers[size];
    marker.header = header;
    marker.ns = occupied ? "occupied" : "free";
    marker.id = static_cast<int>(size);
    marker.type = Marker::CUBE_LIST;
    marker.action = count[size] == 0 ? Marker::DELETE : Marker::ADD;
    marker.pose.orientation.w = 1.0;
    marker.scale.x = marker.scale.y = marker.scale.z = std::ldexp(tree.resolution(), static_cast<int>(size));
    marker.points.reserve(count[size]);
    marker.colors.reserve(count[size]);
  }
  tree.forEachLeaf([&](const OctreeStream::Leaf& leaf) {
    if (leaf.occupied() != occupied) return;
    Marker& marker = array.markers[sizeOf(leaf)];
    const Eigen::Vector3d middle_m = leaf.centre() * tree.resolution();
    geometry_msgs::Point centre;
    centre.x = middle_m.x();
    centre.y = middle_m.y();
    centre.z = middle_m.z();
    marker.points.push_back(centre);
    marker.colors.push_back(colorOf(leaf));
  });
  return array;
}

}  // namespace semantic_vslam
