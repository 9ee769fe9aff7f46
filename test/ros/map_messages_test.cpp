// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/map_messages.h"

#include <gtest/gtest.h>
#include <octomap/OcTree.h>

#include <memory>
#include <sstream>

#include "ros/conversions.h"

namespace semantic_vslam {
namespace {

/// A chair before a wall, 2 m and 3 m away, seen from 1 m above the floor along x of a world whose z is up.
void addRoom(DenseMapper& mapper, std::uint64_t id) {
  CameraIntrinsics k;
  k.width = 64;
  k.height = 48;
  k.fx = k.fy = 50.0;
  k.cx = 32.0;
  k.cy = 24.0;
  const auto camera = std::make_shared<const CameraModel>(k);
  const cv::Size size(64, 48);
  RgbdFrame frame =
      makeRgbdFrame(0, Stamp{1000}, cv::Mat3b(size, cv::Vec3b(10, 20, 30)), cv::Mat1f(size, 3.02F), 1.0, camera);
  frame.depth_m(cv::Rect(20, 20, 20, 20)) = 2.02F;
  cv::Mat1b labels(size, std::uint8_t{0});
  labels(cv::Rect(20, 20, 20, 20)) = 1;
  SE3 T = SE3::Identity();
  T.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  T.translation() = Eigen::Vector3d(0.02 * static_cast<double>(id), 0.0, 1.0);
  mapper.add(KeyframeId(id), frame, labels, {}, T);
}

LabelSet chairs() {
  LabelSet set;
  set.classes.push_back({"chair", Mobility::kMovable, {0, 255, 0}});
  return set;
}

DenseConfig config() {
  DenseConfig config;
  config.keyframe.stride_px = 1;
  config.voxels.resolution_m = 0.05;
  return config;
}

TEST(MapMessages, ShowTheMapAsItIsAfterEachChange) {
  DenseMapper mapper(config(), chairs());
  MapMessages messages{MapObjectsConfig()};
  for (std::uint64_t id = 0; id < 3; ++id) {
    addRoom(mapper, id);
    MapMessages::State state = messages.of(mapper, mapper.labels(), std_msgs::Header());
    EXPECT_EQ(state.cloud()->data, toRos(mapper.cloud(), std_msgs::Header())->data);
    const ObjectArray objects = state.objects();
    ASSERT_EQ(objects.objects.size(), 1U);
    EXPECT_EQ(objects.objects[0].id, 1U) << "the same chair";
    EXPECT_NEAR(objects.objects[0].centroid.x, 2.02 + 0.02 * static_cast<double>(id) / 2.0, 0.03);
    ASSERT_TRUE(state.grid());

    // The same cubes in the tree, as centres and as markers.
    const octomap_msgs::Octomap binary = state.binaryOctomap();
    octomap::OcTree tree(binary.resolution);
    std::istringstream data(std::string(binary.data.begin(), binary.data.end()));
    tree.readBinaryData(data);
    std::size_t occupied = 0, free = 0;
    for (const bool wanted : {true, false}) {
      for (const visualization_msgs::Marker& marker : state.cells(wanted).markers) {
        EXPECT_EQ(marker.points.size(), marker.colors.size());
        (wanted ? occupied : free) += marker.points.size();
        for (const geometry_msgs::Point& point : marker.points) {
          const octomap::OcTreeNode* node = tree.search(point.x + 1e-4, point.y + 1e-4, point.z + 1e-4);
          ASSERT_NE(node, nullptr);
          EXPECT_EQ(tree.isNodeOccupied(node), wanted);
        }
      }
    }
    EXPECT_GT(free, 100U);
    EXPECT_EQ(state.centres()->width * state.centres()->height, occupied);
  }
}

TEST(MapMessages, AnEmptyMapHasNoGrid) {
  DenseMapper mapper(config(), chairs());
  MapMessages messages{MapObjectsConfig()};
  MapMessages::State state = messages.of(mapper, mapper.labels(), std_msgs::Header());
  EXPECT_FALSE(state.grid());
  EXPECT_EQ(state.cloud()->width, 0U);
  EXPECT_TRUE(state.fullOctomap().data.empty());
  EXPECT_TRUE(state.objects().objects.empty());
}

}  // namespace
}  // namespace semantic_vslam
