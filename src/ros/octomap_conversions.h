// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <octomap_msgs/Octomap.h>
#include <sensor_msgs/PointCloud2.h>
#include <std_msgs/Header.h>
#include <visualization_msgs/MarkerArray.h>

#include "core/dense/octomap_export.h"

/// The dense map in the messages of octomap_server.
namespace semantic_vslam {

octomap_msgs::Octomap toRos(OctreeMessage octree, const std_msgs::Header& header);
/// Centres of the occupied leaves, of any size: x y z (float32, metres).
sensor_msgs::PointCloud2Ptr occupiedCentres(const OctreeStream& tree, const std_msgs::Header& header);
/// A list of cubes for each size of leaf: the occupied ones in their colours, or the free ones in green. Sizes that no
/// leaf has are deleted.
visualization_msgs::MarkerArray cubeMarkers(const OctreeStream& tree, bool occupied, const std_msgs::Header& header);

}  // namespace semantic_vslam
