// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/octomap_conversions.h"

#include <cmath>
#include <utility>

#include "ros/conversions.h"

namespace semantic_vslam {
namespace {

constexpr int kSizes = 17;  // an octree of OctoMap has 16 levels below its root

std_msgs::ColorRGBA colorOf(const OctreeLeaf& leaf) {
  std_msgs::ColorRGBA color;
  color.r = static_cast<float>(leaf.bgr[2]) / 255.0F;
  color.g = leaf.occupied ? static_cast<float>(leaf.bgr[1]) / 255.0F : 1.0F;
  color.b = static_cast<float>(leaf.bgr[0]) / 255.0F;
  color.a = leaf.occupied ? 1.0F : 0.15F;  // one looks through free space
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

sensor_msgs::PointCloud2Ptr occupiedCentres(const std::vector<OctreeLeaf>& leaves, const std_msgs::Header& header) {
  std::vector<Eigen::Vector3d> centres;
  for (const OctreeLeaf& leaf : leaves) {
    if (leaf.occupied) centres.push_back(leaf.centre_m);
  }
  return toRos(centres, header);
}

visualization_msgs::MarkerArray cubeMarkers(const std::vector<OctreeLeaf>& leaves, bool occupied, double resolution_m,
                                            const std_msgs::Header& header) {
  using visualization_msgs::Marker;
  visualization_msgs::MarkerArray array;
  array.markers.resize(kSizes);
  for (int size = 0; size < kSizes; ++size) {
    Marker& marker = array.markers[static_cast<std::size_t>(size)];
    marker.header = header;
    marker.ns = occupied ? "occupied" : "free";
    marker.id = size;
    marker.type = Marker::CUBE_LIST;
    marker.pose.orientation.w = 1.0;
    marker.scale.x = marker.scale.y = marker.scale.z = std::ldexp(resolution_m, size);
  }
  for (const OctreeLeaf& leaf : leaves) {
    if (leaf.occupied != occupied) continue;
    Marker& marker = array.markers.at(static_cast<std::size_t>(std::lround(std::log2(leaf.size_m / resolution_m))));
    geometry_msgs::Point centre;
    centre.x = leaf.centre_m.x();
    centre.y = leaf.centre_m.y();
    centre.z = leaf.centre_m.z();
    marker.points.push_back(centre);
    marker.colors.push_back(colorOf(leaf));
  }
  for (Marker& marker : array.markers) marker.action = marker.points.empty() ? Marker::DELETE : Marker::ADD;
  return array;
}

}  // namespace semantic_vslam
