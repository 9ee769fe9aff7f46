// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "core/dense/octree_stream.h"
#include "semantic_vslam/core/dense/dense_result.h"

/// The voxel map as an OctoMap that stock programs read (octovis, octomap_server, octomap_rviz_plugins). The tree is a
/// ColorOcTree: a node type of our own that carried labels could be read by nobody without our library. Labels leave
/// with the cloud (cloud.pcd, PointCloud2), one for each voxel and more finely.
namespace semantic_vslam {

/// Free and occupied only, two bits a node: octomap_msgs' binaryMapToMsg of an OcTree.
OctreeMessage binaryOctree(const OctreeStream& tree);
/// With log-odds and colour: octomap_msgs' fullMapToMsg of a ColorOcTree.
OctreeMessage fullOctree(const OctreeStream& tree);

/// Writes what binaryOctree() holds as a .bt file, whole or not at all. @throws FileError naming path and cause.
void saveBinaryOctree(const OctreeStream& tree, const std::string& path);
/// Writes the ColorOcTree as an .ot file, whole or not at all. @throws FileError naming path and cause.
void saveOctree(const OctreeStream& tree, const std::string& path);

}  // namespace semantic_vslam
