// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "semantic_vslam/core/common/stamp.h"

namespace semantic_vslam {

/// One coloured, labelled point: 16 bytes. In the camera frame in a KeyframeCloud, in the world elsewhere.
struct LabelledPoint {
  cv::Vec3f xyz_m;
  cv::Vec3b bgr;
  std::uint8_t label = 0;

  Eigen::Vector3d position() const { return {xyz_m[0], xyz_m[1], xyz_m[2]}; }
};

/// A nav_msgs/OccupancyGrid in the terms of the core.
struct OccupancyGrid {
  static constexpr std::int8_t kUnknown = -1, kFree = 0, kOccupied = 100;
  int width = 0, height = 0;  ///< cells along x and y of the map frame
  double resolution_m = 0.0;
  double origin_x_m = 0.0, origin_y_m = 0.0;  ///< of the outer corner of cell (0, 0)
  std::vector<std::int8_t> cells;             ///< cell (x, y) at y * width + x

  std::int8_t at(int x, int y) const { return cells[static_cast<std::size_t>(y) * width + x]; }
};

/// Fields of octomap_msgs/Octomap.
struct OctreeMessage {
  bool binary = false;
  std::string id;  ///< class of the tree: "OcTree" or "ColorOcTree"
  double resolution_m = 0.0;
  std::vector<std::int8_t> data;  ///< empty for an empty map
};

/// A thing in the map, of one class.
struct MapObject {
  std::uint32_t id = 0;  ///< stays while the thing does, see ObjectList; 0: not given
  std::uint8_t label = 0;
  int points = 0;
  double confidence = 0.0;                               ///< share of the votes over its surface that are for the label
  Stamp last_seen;                                       ///< newest frame with a point on it
  Eigen::Vector3d centroid_m = Eigen::Vector3d::Zero();  ///< mean of its seen surface, however densely that was seen
  Eigen::AlignedBox3d box_m;                             ///< round its points, along the axes of the cloud's frame
  /// The smallest upright box round its points: its middle, its size along its own axes, and its turn about z.
  Eigen::Vector3d middle_m = Eigen::Vector3d::Zero(), size_m = Eigen::Vector3d::Zero();
  double yaw_rad = 0.0;
};

}  // namespace semantic_vslam
