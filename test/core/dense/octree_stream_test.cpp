// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/dense/octree_stream.h"

#include <gtest/gtest.h>
#include <octomap/ColorOcTree.h>

#include <algorithm>
#include <sstream>

#include "dense_scene.h"

namespace semantic_vslam {
namespace {

/// The same tree, made by OctoMap itself.
octomap::ColorOcTree treeOfOctomap(const VoxelMap& map) {
  octomap::ColorOcTree tree(map.resolution());
  map.forEachKnown([&](const Voxel& voxel) {
    octomap::OcTreeKey key;
    for (unsigned axis = 0; axis < 3; ++axis) {
      key[axis] = static_cast<octomap::key_type>(voxel.index[static_cast<int>(axis)] + (1 << 15));
    }
    const bool occupied = voxel.state == Occupancy::kOccupied;
    const double log_odds = occupied ? voxel.log_odds : std::min(voxel.log_odds, -0.001);
    octomap::ColorOcTreeNode* node = tree.setNodeValue(key, static_cast<float>(log_odds), true);
    if (occupied) node->setColor(voxel.bgr[2], voxel.bgr[1], voxel.bgr[0]);
  });
  tree.updateInnerOccupancy();
  tree.prune();
  return tree;
}

std::string fullDataOf(const octomap::ColorOcTree& tree) {
  std::ostringstream stream;
  tree.writeData(stream);
  return stream.str();
}

std::string binaryDataOf(octomap::ColorOcTree tree) {
  tree.toMaxLikelihood();
  tree.prune();
  std::ostringstream stream;
  tree.writeBinaryData(stream);
  return stream.str();
}

void integrateRandomly(Rng& rng, VoxelMap& map) {
  KeyframeCloudConfig config;
  config.stride_px = 1;
  const RgbdFrame frame = randomFrame(rng);
  const auto cloud = makeKeyframeCloud(KeyframeId(0), frame, cv::Mat1b(), cv::Mat1b(), config);
  map.integrate(cloud.points, makeFreeSpaceView(frame, cv::Mat1b(), cv::Mat1b(), config, 2), randomPose(rng));
}

TEST(OctreeStream, IsWhatOctomapWritesAfterEveryChange) {
  VoxelMapConfig config;
  config.resolution_m = 0.08;
  VoxelMap map(config);
  OctreeStream kept;
  Rng rng(3);
  for (int i = 0; i < 12; ++i) {
    integrateRandomly(rng, map);
    kept.update(map);
    const octomap::ColorOcTree tree = treeOfOctomap(map);
    ASSERT_TRUE(kept.full() == fullDataOf(tree)) << i;
    ASSERT_TRUE(kept.binary() == binaryDataOf(tree)) << i;
    auto leaf = tree.begin_leafs();
    std::size_t leaves = 0;
    kept.forEachLeaf([&](const OctreeStream::Leaf& own) {
      ++leaves;
      ASSERT_NEAR((own.corner.x() + own.side / 2.0) * map.resolution(), leaf.getX(), 1e-6);
      ASSERT_NEAR((own.corner.z() + own.side / 2.0) * map.resolution(), leaf.getZ(), 1e-6);
      ASSERT_EQ(own.log_odds, leaf->getLogOdds());
      ++leaf;
    });
    EXPECT_EQ(leaves, tree.getNumLeafNodes());
  }
}

TEST(OctreeStream, WhatWasSeenAndIsGoneIsFreeForOctomapToo) {
  VoxelMapConfig config;
  config.resolution_m = 0.1;
  VoxelMap map(config);
  KeyframeCloudConfig cloud_config;
  cloud_config.stride_px = 1;
  for (const float depth_m : {1.05F, 1.05F, 1.05F, 1.05F, 1.05F, 1.05F, 3.05F, 3.05F, 3.05F}) {
    const RgbdFrame frame = wallFrame(depth_m);
    const auto cloud = makeKeyframeCloud(KeyframeId(0), frame, cv::Mat1b(), cv::Mat1b(), cloud_config);
    map.integrate(cloud.points, makeFreeSpaceView(frame, cv::Mat1b(), cv::Mat1b(), cloud_config, 2), SE3::Identity());
  }
  const Voxel gone = map.voxelAt({0.05, 0.05, 1.05});
  ASSERT_EQ(gone.state, Occupancy::kFree);
  ASSERT_EQ(gone.log_odds, 0.0) << "three views take away what any number put there, and no more";
  octomap::ColorOcTree tree(0.1);
  std::istringstream data(OctreeStream(map).full());
  tree.readData(data);
  const octomap::ColorOcTreeNode* node = tree.search(0.05, 0.05, 1.05);
  ASSERT_NE(node, nullptr);
  EXPECT_FALSE(tree.isNodeOccupied(node));
}

TEST(OctreeStream, MemoryIsCountedAndOnlyGrowsWithTheMap) {
  VoxelMap map{VoxelMapConfig()};
  OctreeStream stream;
  Rng rng(1);
  integrateRandomly(rng, map);
  stream.update(map);
  const std::size_t bytes = stream.memoryBytes();
  EXPECT_GT(bytes, stream.full().size());
  stream.update(map);
  EXPECT_EQ(stream.memoryBytes(), bytes);
}

}  // namespace
}  // namespace semantic_vslam
