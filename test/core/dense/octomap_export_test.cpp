// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/dense/octomap_export.h"

#include <gtest/gtest.h>
#include <octomap/ColorOcTree.h>
#include <octomap/OcTree.h>

#include <cstdio>
#include <memory>
#include <sstream>

#include "dense_scene.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

/// A red wall at 2.05 m, seen twice.
VoxelMap wallMap() {
  VoxelMapConfig config;
  config.resolution_m = 0.1;
  VoxelMap map(config);
  const RgbdFrame frame = wallFrame(2.05F, {0, 0, 200});
  const auto cloud = makeKeyframeCloud(KeyframeId(0), frame, cv::Mat1b(), cv::Mat1b(), KeyframeCloudConfig());
  for (int i = 0; i < 2; ++i)
    map.integrate(cloud.points, makeFreeSpaceView(frame, cv::Mat1b(), cv::Mat1b(), KeyframeCloudConfig(), 2),
                  SE3::Identity());
  return map;
}

/// Every voxel of the map has its node in the tree with the same state, and the tree has no other leaf.
void expectSame(const VoxelMap& map, const octomap::OccupancyOcTreeBase<octomap::OcTreeNode>& tree) {
  map.forEachKnown([&](const Voxel& voxel) {
    const Eigen::Vector3d p = map.centre(voxel.index);
    const octomap::OcTreeNode* node = tree.search(p.x(), p.y(), p.z());
    ASSERT_NE(node, nullptr) << p.transpose();
    EXPECT_EQ(tree.isNodeOccupied(node), voxel.state == Occupancy::kOccupied) << p.transpose();
  });
}

TEST(OctomapExport, FileIsReadByStockOctomapWithStateAndColour) {
  const VoxelMap map = wallMap();
  const std::string path = testing::TempDir() + "semantic_octree_test.ot";
  saveOctree(OctreeStream(map), path);
  const std::unique_ptr<octomap::AbstractOcTree> read(octomap::AbstractOcTree::read(path));
  std::remove(path.c_str());
  const auto* tree = dynamic_cast<octomap::ColorOcTree*>(read.get());
  ASSERT_NE(tree, nullptr);
  EXPECT_DOUBLE_EQ(tree->getResolution(), 0.1);
  const octomap::ColorOcTreeNode* wall = tree->search(0.05, 0.05, 2.05);
  ASSERT_NE(wall, nullptr);
  EXPECT_TRUE(tree->isNodeOccupied(wall));
  EXPECT_NEAR(wall->getLogOdds(), map.voxelAt({0.05, 0.05, 2.05}).log_odds, 1e-5);
  EXPECT_EQ(wall->getColor(), octomap::ColorOcTreeNode::Color(200, 0, 0));
  const octomap::ColorOcTreeNode* air = tree->search(0.05, 0.05, 1.05);
  ASSERT_NE(air, nullptr);
  EXPECT_FALSE(tree->isNodeOccupied(air));
  EXPECT_EQ(tree->search(0.05, 0.05, 2.35), nullptr);  // behind the wall: unknown
}

TEST(OctomapExport, BinaryMessageIsWhatAnOcTreeReads) {
  const VoxelMap map = wallMap();
  const OctreeMessage message = binaryOctree(OctreeStream(map));
  EXPECT_TRUE(message.binary);
  EXPECT_EQ(message.id, "OcTree");
  octomap::OcTree tree(message.resolution_m);
  std::istringstream stream(std::string(message.data.begin(), message.data.end()));
  tree.readBinaryData(stream);  // as octomap_msgs::binaryMsgToMap does
  expectSame(map, tree);
}

TEST(OctomapExport, BinaryFileIsReadByStockOctomap) {
  const std::string path = testing::TempDir() + "semantic_octree_test.bt";
  const VoxelMap map = wallMap();
  saveBinaryOctree(OctreeStream(map), path);
  octomap::OcTree tree(1.0);
  ASSERT_TRUE(tree.readBinary(path));
  EXPECT_DOUBLE_EQ(tree.getResolution(), 0.1);
  expectSame(map, tree);
  saveBinaryOctree(OctreeStream(VoxelMap(VoxelMapConfig())), path);
  ASSERT_TRUE(tree.readBinary(path));
  EXPECT_EQ(tree.size(), 0U);
  std::remove(path.c_str());
}

TEST(OctomapExport, LeavesFillTheKnownSpaceOnce) {
  const VoxelMap map = wallMap();
  const double voxel_m3 = 0.1 * 0.1 * 0.1;
  double volume_m3 = 0.0;
  OctreeStream(map).forEachLeaf([&](const OctreeStream::Leaf& leaf) {
    volume_m3 += voxel_m3 * leaf.side * leaf.side * leaf.side;
    const Voxel middle = map.voxelAt(leaf.centre() * map.resolution() - Eigen::Vector3d::Constant(0.01));
    EXPECT_EQ(leaf.occupied(), middle.state == Occupancy::kOccupied);
    EXPECT_EQ(leaf.rgb, leaf.occupied() ? OctreeNode::Rgb({200, 0, 0}) : OctreeNode::kNoColour);
  });
  EXPECT_NEAR(volume_m3, voxel_m3 * static_cast<double>(map.size()), voxel_m3 / 2.0);
}

TEST(OctomapExport, FullMessageIsWhatAColorOcTreeReads) {
  const VoxelMap map = wallMap();
  const OctreeMessage message = fullOctree(OctreeStream(map));
  EXPECT_FALSE(message.binary);
  EXPECT_EQ(message.id, "ColorOcTree");
  octomap::ColorOcTree tree(message.resolution_m);
  std::istringstream stream(std::string(message.data.begin(), message.data.end()));
  tree.readData(stream);   // as octomap_msgs::fullMsgToMap does
  std::size_t volume = 0;  // of all leaves, in voxels
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
    const auto side = static_cast<std::size_t>(1) << (tree.getTreeDepth() - leaf.getDepth());
    volume += side * side * side;
  }
  EXPECT_EQ(volume, map.size());
}

TEST(OctomapExport, AnEmptyMapIsAnEmptyTree) {
  const VoxelMap empty{VoxelMapConfig()};
  EXPECT_TRUE(fullOctree(OctreeStream(empty)).data.empty());
  EXPECT_TRUE(binaryOctree(OctreeStream(empty)).data.empty());
  const std::string path = testing::TempDir() + "semantic_octree_empty_test.ot";
  saveOctree(OctreeStream(empty), path);
  const std::unique_ptr<octomap::AbstractOcTree> read(octomap::AbstractOcTree::read(path));
  std::remove(path.c_str());
  ASSERT_NE(read, nullptr);
  EXPECT_EQ(read->size(), 0U);
}

}  // namespace
}  // namespace semantic_vslam
