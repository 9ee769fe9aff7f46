// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/dense/octomap_export.h"

#include <octomap/ColorOcTree.h>
#include <octomap/OcTree.h>

#include <sstream>

#include "core/common/atomic_file.h"

namespace semantic_vslam {
namespace {

/// OctoMap's keys count voxels from -32768; what lies outside (983 m at 3 cm) cannot be expressed and stays out.
bool octreeKey(const Eigen::Vector3i& index, octomap::OcTreeKey& key) {
  constexpr int kCentre = 1 << 15;
  for (int axis = 0; axis < 3; ++axis) {
    const int shifted = index[axis] + kCentre;
    if (shifted < 0 || shifted >= 2 * kCentre) return false;
    key[static_cast<unsigned>(axis)] = static_cast<octomap::key_type>(shifted);
  }
  return true;
}

octomap::ColorOcTree makeOctree(const VoxelMap& map) {
  octomap::ColorOcTree tree(map.resolution());
  map.forEachKnown([&](const Voxel& voxel) {
    octomap::OcTreeKey key;
    if (!octreeKey(voxel.index, key)) return;
    constexpr bool kLazy = true;  // inner nodes are made up once, below
    octomap::ColorOcTreeNode* node = tree.setNodeValue(key, static_cast<float>(voxel.log_odds), kLazy);
    if (voxel.state == Occupancy::kOccupied) node->setColor(voxel.bgr[2], voxel.bgr[1], voxel.bgr[0]);
  });
  if (tree.size() == 0) return tree;  // OctoMap follows a null root otherwise
  tree.updateInnerOccupancy();
  tree.prune();
  return tree;
}

OctreeMessage toMessage(const std::ostringstream& stream, double resolution_m) {
  const std::string bytes = stream.str();
  OctreeMessage message;
  message.resolution_m = resolution_m;
  message.data.assign(bytes.begin(), bytes.end());
  return message;
}

void writeBinaryData(const VoxelMap& map, std::ostream& stream) {
  octomap::ColorOcTree tree = makeOctree(map);
  tree.toMaxLikelihood();  // the two-bit stream holds only leaves that are surely free or occupied
  tree.prune();
  tree.writeBinaryData(stream);
}

}  // namespace

OctreeMessage binaryOctree(const VoxelMap& map) {
  std::ostringstream stream;
  writeBinaryData(map, stream);
  OctreeMessage message = toMessage(stream, map.resolution());
  message.binary = true;
  message.id = "OcTree";  // its two-bit stream is the same, and every reader knows it
  return message;
}

OctreeMessage fullOctree(const VoxelMap& map) {
  const octomap::ColorOcTree tree = makeOctree(map);
  std::ostringstream stream;
  tree.writeData(stream);
  OctreeMessage message = toMessage(stream, map.resolution());
  message.id = tree.getTreeType();
  return message;
}

std::vector<OctreeLeaf> octreeLeaves(const VoxelMap& map) {
  std::vector<OctreeLeaf> leaves;
  const octomap::ColorOcTree tree = makeOctree(map);
  for (auto node = tree.begin_leafs(); node != tree.end_leafs(); ++node) {
    const octomap::ColorOcTreeNode::Color color = node->getColor();
    const bool occupied = tree.isNodeOccupied(*node);
    leaves.push_back({{node.getX(), node.getY(), node.getZ()},
                      node.getSize(),
                      occupied,
                      occupied ? cv::Vec3b(color.b, color.g, color.r) : cv::Vec3b()});
  }
  return leaves;
}

void saveBinaryOctree(const VoxelMap& map, const std::string& path) {
  std::stringstream data;
  writeBinaryData(map, data);
  octomap::OcTree tree(map.resolution());
  if (data.tellp() > 0) tree.readBinaryData(data);
  std::ostringstream file;
  tree.writeBinaryConst(file);
  writeTextAtomically(path, file.str());
}

void saveOctree(const VoxelMap& map, const std::string& path) {
  std::ostringstream stream;
  makeOctree(map).write(stream);
  writeTextAtomically(path, stream.str());
}

}  // namespace semantic_vslam
