// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/dense/octomap_export.h"

#include <octomap/ColorOcTree.h>
#include <octomap/OcTree.h>

#include <sstream>

#include "core/common/atomic_file.h"

namespace semantic_vslam {
namespace {

OctreeMessage toMessage(const std::string& bytes, double resolution_m) {
  OctreeMessage message;
  message.resolution_m = resolution_m;
  message.data.assign(bytes.begin(), bytes.end());
  return message;
}

}  // namespace

OctreeMessage binaryOctree(const OctreeStream& tree) {
  OctreeMessage message = toMessage(tree.binary(), tree.resolution());
  message.binary = true;
  message.id = "OcTree";  // its two-bit stream is that of every class, and every reader knows it
  return message;
}

OctreeMessage fullOctree(const OctreeStream& tree) {
  OctreeMessage message = toMessage(tree.full(), tree.resolution());
  message.id = "ColorOcTree";
  return message;
}

void saveBinaryOctree(const OctreeStream& tree, const std::string& path) {
  std::istringstream data(tree.binary());
  octomap::OcTree octree(tree.resolution());
  if (!data.str().empty()) octree.readBinaryData(data);
  std::ostringstream file;
  octree.writeBinaryConst(file);
  writeTextAtomically(path, file.str());
}

void saveOctree(const OctreeStream& tree, const std::string& path) {
  std::istringstream data(tree.full());
  octomap::ColorOcTree octree(tree.resolution());
  if (!data.str().empty()) octree.readData(data);
  std::ostringstream file;
  octree.write(file);
  writeTextAtomically(path, file.str());
}

}  // namespace semantic_vslam
