// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/dense/keyframe_cloud.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "dense_scene.h"

namespace semantic_vslam {
namespace {

KeyframeCloudConfig everyPixel() {
  KeyframeCloudConfig config;
  config.stride_px = 1;
  config.dynamic_margin_px = 0;
  return config;
}

std::size_t pointsFrom(const RgbdFrame& frame, const KeyframeCloudConfig& config) {
  return makeKeyframeCloud(KeyframeId(0), frame, cv::Mat1b(), cv::Mat1b(), config).points.size();
}

TEST(KeyframeCloud, PutsEachPixelOnItsRayAtItsDepth) {
  RgbdFrame frame = wallFrame(0.0F);
  frame.depth_m(24, 32) = 2.0F;  // the optical axis
  frame.depth_m(4, 57) = 1.0F;   // (57 - 32) / 50 = 0.5 right, (4 - 24) / 50 = 0.4 up
  frame.bgr(4, 57) = {1, 2, 3};
  cv::Mat1b labels(frame.depth_m.size(), std::uint8_t{0});
  labels(4, 57) = 2;
  const KeyframeCloud cloud = makeKeyframeCloud(KeyframeId(7), frame, labels, cv::Mat1b(), everyPixel());
  EXPECT_EQ(cloud.keyframe, KeyframeId(7));
  EXPECT_EQ(cloud.stamp, Stamp{1000});
  ASSERT_EQ(cloud.points.size(), 2U);
  EXPECT_LT(cv::norm(cloud.points[0].xyz_m - cv::Vec3f(0.5F, -0.4F, 1.0F)), 1e-6);
  EXPECT_EQ(cloud.points[0].bgr, cv::Vec3b(1, 2, 3));
  EXPECT_EQ(cloud.points[0].label, 2);
  EXPECT_LT(cv::norm(cloud.points[1].xyz_m - cv::Vec3f(0.0F, 0.0F, 2.0F)), 1e-6);
  EXPECT_EQ(cloud.points[1].label, 0);
}

TEST(KeyframeCloud, KeepsEveryNthPixelWithinTheDepthRange) {
  KeyframeCloudConfig config = everyPixel();
  EXPECT_EQ(pointsFrom(wallFrame(2.0F), config), 64U * 48U);
  config.stride_px = 4;
  EXPECT_EQ(pointsFrom(wallFrame(2.0F), config), 16U * 12U);
  EXPECT_EQ(pointsFrom(wallFrame(0.29F), config), 0U);
  EXPECT_EQ(pointsFrom(wallFrame(4.01F), config), 0U);
}

TEST(KeyframeCloud, ExcludesWhatMovesWithAMargin) {
  KeyframeCloudConfig config = everyPixel();
  config.dynamic_margin_px = 3;
  const cv::Size size(64, 48);
  cv::Mat1b dynamic(size, std::uint8_t{127});  // not enough to count
  dynamic(20, 30) = 128;
  const cv::Mat1b excluded = excludedPixels(cv::Mat1f(size, 2.0F), someonePixels(size, {}, dynamic, {}), config);
  EXPECT_EQ(cv::countNonZero(excluded), 7 * 7);
  EXPECT_EQ(excluded(17, 27), 255);
  EXPECT_EQ(excluded(16, 27), 0);
  const auto cloud = makeKeyframeCloud(KeyframeId(0), wallFrame(2.0F), cv::Mat1b(), excluded, config);
  EXPECT_EQ(cloud.points.size(), 64U * 48U - 49U);
}

TEST(KeyframeCloud, ExcludesPeopleEvenWhereNothingMoves) {
  const cv::Size size(64, 48);
  cv::Mat1b labels(size, std::uint8_t{2});
  labels(10, 10) = 1;
  labels(11, 11) = 200;  // not in the set: static
  const cv::Mat1b still(size, std::uint8_t{0});
  const cv::Mat1b excluded =
      excludedPixels(cv::Mat1f(size, 2.0F), someonePixels(size, labels, still, threeLabels()), everyPixel());
  EXPECT_EQ(cv::countNonZero(excluded), 1);
  EXPECT_EQ(excluded(10, 10), 255);
  for (const auto& point : makeKeyframeCloud(KeyframeId(0), wallFrame(2.0F), labels, excluded, everyPixel()).points) {
    EXPECT_NE(point.label, 1);
  }
}

TEST(KeyframeCloud, DropsPixelsBetweenForegroundAndBackground) {
  RgbdFrame frame = wallFrame(3.0F);
  frame.depth_m.colRange(0, 30) = 1.0F;
  frame.depth_m.col(30) = 2.1F;  // flies between the two
  const auto cloud = makeKeyframeCloud(KeyframeId(0), frame, cv::Mat1b(), cv::Mat1b(), everyPixel());
  for (const auto& point : cloud.points) {
    EXPECT_TRUE(point.xyz_m[2] == 1.0F || point.xyz_m[2] == 3.0F) << point.xyz_m[2];
  }
  EXPECT_EQ(cloud.points.size(), 48U * (64U - 3U));  // the flying column and one on each side
}

TEST(KeyframeCloud, KeepsATiltedPlaneAndDropsAGrazingOne) {
  // Depth along a column of a plane that leaves the axis at z0: z(u) = z0 / (1 - x(u) tan(angle)).
  const auto plane = [](double angle_deg) {
    RgbdFrame frame = wallFrame(0.0F);
    for (int v = 0; v < 48; ++v) {
      for (int u = 0; u < 64; ++u) {
        const double z = 1.5 / (1.0 - (u - 32) / 50.0 * std::tan(angle_deg * CV_PI / 180.0));
        if (z > 0.5 && z < 3.0) frame.depth_m(v, u) = static_cast<float>(z);
      }
    }
    return frame;
  };
  KeyframeCloudConfig config = everyPixel();
  config.depth_noise.surfaces_m = 0.0001;
  const cv::Mat1f tilted = plane(45.0).depth_m, grazing = plane(87.0).depth_m;
  EXPECT_EQ(cv::countNonZero(depthEdges(tilted, 50.0, config)), 0);
  cv::Mat inside;  // pixels with a neighbour on each side: at the border of the plane one step is too few to tell
  cv::erode(grazing > 0.0F, inside, cv::Mat());
  ASSERT_GT(cv::countNonZero(inside), 40);
  EXPECT_EQ(cv::countNonZero((depthEdges(grazing, 50.0, config) == 0) & inside), 0);
}

TEST(KeyframeCloud, AHoleIsNoDepthEdge) {
  RgbdFrame frame = wallFrame(2.0F);
  frame.depth_m(10, 10) = 0.0F;
  EXPECT_EQ(pointsFrom(frame, everyPixel()), 64U * 48U - 1U);
}

TEST(VoxelFilter, AveragesACubeAndTakesItsMostFrequentLabel) {
  const std::vector<LabelledPoint> points = {{{0.01F, 0.01F, 0.01F}, {0, 0, 0}, 5},
                                             {{-0.02F, 0.01F, 0.01F}, {9, 9, 9}, 1},  // another cube
                                             {{0.03F, 0.02F, 0.04F}, {30, 60, 90}, 2},
                                             {{0.05F, 0.03F, 0.01F}, {60, 120, 30}, 2}};
  const auto filtered = voxelFilter(points, 0.1);
  ASSERT_EQ(filtered.size(), 2U);
  EXPECT_EQ(filtered[0].label, 1);
  EXPECT_LT(cv::norm(filtered[1].xyz_m - cv::Vec3f(0.03F, 0.02F, 0.02F)), 1e-6);
  EXPECT_EQ(filtered[1].bgr, cv::Vec3b(30, 60, 40));
  EXPECT_EQ(filtered[1].label, 2);
}

TEST(ExcludedPixels, GoOnAlongTheBodyThatWasSeenToMoveInPart) {
  KeyframeCloudConfig config;
  config.dynamic_margin_px = 0;
  cv::Mat1f depth_m(480, 640, 3.0F);
  const cv::Rect body(200, 96, 80, 224);
  depth_m(body) = 1.5F;
  cv::Mat1b dynamic(depth_m.size(), std::uint8_t{0});
  dynamic(cv::Rect(190, 96, 100, 120)) = 255;  // the upper half, and a rim of the wall behind
  const cv::Mat1b excluded = excludedPixels(depth_m, dynamic, config);
  EXPECT_EQ(cv::countNonZero(excluded(body)), body.area());
  EXPECT_EQ(cv::countNonZero(excluded) - cv::countNonZero(dynamic), 80 * 104);  // nothing of the wall
}

TEST(ExcludedPixels, GoOnAlongTheStripOfABodyThatIsInView) {
  KeyframeCloudConfig config;
  config.dynamic_margin_px = 0;
  cv::Mat1f depth_m(480, 640, 3.0F);
  const cv::Rect body(624, 200, 16, 120);
  depth_m(body) = 1.5F;
  cv::Mat1b someone(depth_m.size(), std::uint8_t{0});
  someone(cv::Rect(624, 200, 16, 60)) = 255;
  EXPECT_EQ(cv::countNonZero(excludedPixels(depth_m, someone, config)(body)), body.area());
}

}  // namespace
}  // namespace semantic_vslam
