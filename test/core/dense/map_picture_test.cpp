// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/dense/map_picture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <opencv2/imgcodecs.hpp>

#include "core/common/rng.h"
#include "dense_scene.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

/// A floor of 2 m x 2 m with this normal (in the plane of y and z) (red, chair) with a wall of fewer points (blue,
/// background) at its end.
std::vector<LabelledPoint> floorAndWall(const Eigen::Vector3d& up) {
  const Eigen::Vector3d across = Eigen::Vector3d::UnitX(), along = across.cross(up).normalized();
  std::vector<LabelledPoint> cloud;
  const auto add = [&](const Eigen::Vector3d& p, const cv::Vec3b& bgr, std::uint8_t label) {
    cloud.push_back({cv::Vec3f(cv::Vec3d(p.x(), p.y(), p.z())), bgr, label});
  };
  for (int i = -100; i < 100; ++i) {
    for (int j = 0; j < 200; ++j) add(across * 0.01 * i + along * 0.01 * j - up, {0, 0, 200}, 2);
    for (int j = 0; j < 60; ++j) add(across * 0.01 * i + along * 2.0 + up * (0.01 * j - 1.0), {200, 0, 0}, 0);
  }
  return cloud;
}

std::size_t countColour(const cv::Mat3b& image, const cv::Vec3b& low, const cv::Vec3b& high) {
  cv::Mat mask;
  cv::inRange(image, low, high, mask);
  return static_cast<std::size_t>(cv::countNonZero(mask));
}

TEST(EstimateUpDirection, IsTheNormalOfTheLargestFlatSurface) {
  const Eigen::Vector3d up = Eigen::Vector3d(0.0, -0.9, -0.4).normalized();
  const Eigen::Vector3d estimate = estimateUpDirection(floorAndWall(up), -Eigen::Vector3d::UnitY());
  EXPECT_LT(std::acos(std::min(1.0, estimate.dot(up))), 1e-3);
  EXPECT_EQ(estimate, estimateUpDirection(floorAndWall(up), -Eigen::Vector3d::UnitY()));
}

TEST(EstimateUpDirection, FallsBackOnThePriorWithoutAPlane) {
  Rng rng(3);
  std::vector<LabelledPoint> cloud(4000);
  for (auto& point : cloud) {
    point.xyz_m = cv::Vec3f(static_cast<float>(rng.uniform(-5, 5)), static_cast<float>(rng.uniform(-5, 5)),
                            static_cast<float>(rng.uniform(-5, 5)));
  }
  const Eigen::Vector3d prior = -Eigen::Vector3d::UnitY();
  EXPECT_EQ(estimateUpDirection(cloud, prior), prior);
  EXPECT_EQ(estimateUpDirection({}, prior), prior);
}

TEST(MapPicture, ShowsCloudLabelsAndPath) {
  std::vector<SE3> trajectory;
  for (int i = 0; i < 20; ++i) {
    SE3 T = SE3::Identity();
    T.translation().x() = 0.02 * i;
    trajectory.push_back(T);
  }
  MapPictureConfig config;
  config.view_width_px = 400;
  config.view_height_px = 300;
  const cv::Mat3b picture = drawMapPicture(floorAndWall(-Eigen::Vector3d::UnitY()), trajectory, threeLabels(), config);
  EXPECT_EQ(picture.cols, 800);
  EXPECT_GT(picture.rows, 600);
  for (const int row : {0, 300}) {  // perspective, from above
    const cv::Mat3b camera = picture(cv::Rect(0, row, 400, 300)), labels = picture(cv::Rect(400, row, 400, 300));
    EXPECT_GT(countColour(camera, {0, 0, 70}, {10, 10, 255}), 6000U) << row;   // the red floor
    EXPECT_GT(countColour(labels, {0, 70, 0}, {10, 255, 10}), 6000U) << row;   // is a chair, green
    EXPECT_GT(countColour(camera, {0, 190, 255}, {0, 190, 255}), 20U) << row;  // the path
  }
}

TEST(MapPicture, AnEmptyMapIsAnEmptyPicture) {
  MapPictureConfig config;
  config.view_width_px = 400;
  config.view_height_px = 300;
  EXPECT_FALSE(drawMapPicture({}, {}, LabelSet(), config).empty());
}

TEST(MapPicture, IsWrittenAsPngOrTheErrorNamesThePath) {
  const std::string path = testing::TempDir() + "map_picture_test.png";
  MapPictureConfig config;
  config.view_width_px = 400;
  config.view_height_px = 300;
  saveMapPicture(path, {}, {}, LabelSet(), config);
  EXPECT_EQ(cv::imread(path).cols, 800);
  std::remove(path.c_str());
  EXPECT_THROW(saveMapPicture("/nonexistent_folder/map.png", {}, {}, LabelSet(), config), FileError);
}

}  // namespace
}  // namespace semantic_vslam
