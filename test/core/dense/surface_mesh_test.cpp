// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/dense/surface_mesh.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <iterator>

#include "dense_scene.h"

namespace semantic_vslam {
namespace {

VoxelMap wallMap(float depth_m) {
  VoxelMapConfig voxels;
  voxels.resolution_m = 0.05;
  VoxelMap map(voxels);
  KeyframeCloudConfig config;
  config.stride_px = 1;
  const RgbdFrame frame = wallFrame(depth_m);
  const KeyframeCloud cloud = makeKeyframeCloud(KeyframeId(0), frame, {}, {}, config);
  for (int i = 0; i < 3; ++i) map.integrate(cloud.points, makeFreeSpaceView(frame, {}, {}, config, 2), SE3::Identity());
  return map;
}

TEST(SurfaceMesh, AWallIsFlatAndFacesTheCamera) {
  const SurfaceMesh mesh = makeSurfaceMesh(wallMap(2.02F));
  ASSERT_GT(mesh.triangles.size(), 1000U);
  double area_m2 = 0.0;
  for (const auto& triangle : mesh.triangles) {
    const Eigen::Vector3d a = mesh.vertices.at(triangle[0]).position(), b = mesh.vertices.at(triangle[1]).position(),
                          c = mesh.vertices.at(triangle[2]).position();
    const Eigen::Vector3d normal = (b - a).cross(c - a);
    EXPECT_LT(normal.z(), 0.0) << "towards free space";
    area_m2 += 0.5 * normal.norm();
  }
  for (const LabelledPoint& vertex : mesh.vertices) {
    EXPECT_NEAR(vertex.xyz_m[2], 2.02F, 0.005F);
    EXPECT_EQ(vertex.bgr, cv::Vec3b(10, 20, 30));
  }
  const double seen_m2 = (64 * 2.02 / 50) * (48 * 2.02 / 50);
  EXPECT_NEAR(area_m2, seen_m2, 0.15 * seen_m2);
}

TEST(SurfaceMesh, AnEmptyMapHasNone) { EXPECT_TRUE(makeSurfaceMesh(VoxelMap(VoxelMapConfig())).vertices.empty()); }

TEST(SurfaceMesh, TheFileNamesTheLabelsAndHoldsAllOfIt) {
  const SurfaceMesh mesh = makeSurfaceMesh(wallMap(2.02F));
  const std::string path = ::testing::TempDir() + "/mesh_" + std::to_string(getpid()) + ".ply";
  writePly(mesh, threeLabels(), path);
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  const std::size_t header = bytes.find("end_header\n");
  ASSERT_NE(header, std::string::npos);
  EXPECT_NE(bytes.find("comment label 2 chair\n"), std::string::npos);
  EXPECT_EQ(bytes.size(), header + 11 + 16 * mesh.vertices.size() + 13 * mesh.triangles.size());
  unlink(path.c_str());
}

}  // namespace
}  // namespace semantic_vslam
