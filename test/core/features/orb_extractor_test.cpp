// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/features/orb_extractor.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <set>

#include "core/common/rng.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

/// Random rectangles of random grey: corners everywhere; the left half has five times the contrast of the right.
RgbdFrame texturedFrame() {
  Rng rng(3);
  cv::Mat1b gray(480, 640, 128);
  for (int i = 0; i < 1500; ++i) {
    const int u = static_cast<int>(rng.below(630)), v = static_cast<int>(rng.below(470));
    const int contrast = u < 320 ? 100 : 20;
    const int value = 128 + static_cast<int>(rng.below(2 * contrast)) - contrast;
    cv::rectangle(gray, cv::Rect(u, v, 5 + static_cast<int>(rng.below(25)), 5 + static_cast<int>(rng.below(25))),
                  cv::Scalar(value), cv::FILLED);
  }
  return makeRgbdFrame(0, Stamp{1}, gray, cv::Mat(480, 640, CV_32FC1, cv::Scalar(2.0)), 0.001,
                       std::make_shared<CameraModel>(CameraIntrinsics()));
}

TEST(OrbExtractor, SpreadsOverImageAndPyramid) {
  const FrameFeatures found = OrbExtractor(OrbConfig()).extract(texturedFrame(), {});
  EXPECT_NEAR(static_cast<double>(found.size()), 1000.0, 20.0);
  EXPECT_EQ(found.descriptors.rows, static_cast<int>(found.size()));
  std::set<int> cells;
  std::array<int, kPyramidLevels> per_level{};
  int right_half = 0;
  for (const Feature& feature : found.features) {
    cells.insert(static_cast<int>(feature.raw_px.y() / 80) * 8 + static_cast<int>(feature.raw_px.x() / 80));
    ++per_level[feature.octave];
    if (feature.raw_px.x() >= 320) ++right_half;
    EXPECT_FLOAT_EQ(feature.depth_m, 2.0F);
    EXPECT_FLOAT_EQ(feature.static_weight, 1.0F);
  }
  EXPECT_EQ(cells.size(), 48U) << "every 80 px block of the image holds features";
  EXPECT_GT(right_half, 400) << "weak contrast must not starve half of the image";
  for (int level = 0; level < kPyramidLevels; ++level) EXPECT_GT(per_level[level], 30) << "level " << level;
}

TEST(OrbExtractor, FindsTheSameCornersInAShiftedImage) {
  const RgbdFrame frame = texturedFrame();
  cv::Mat1b shifted;
  cv::warpAffine(frame.gray, shifted, cv::Matx23d(1, 0, 6, 0, 1, 4), frame.gray.size());
  const RgbdFrame moved = makeRgbdFrame(1, Stamp{2}, shifted, frame.depth_m, 0.001, frame.camera);
  const OrbExtractor orb{OrbConfig()};
  const FrameFeatures a = orb.extract(frame, {}), b = orb.extract(moved, {});
  int repeated = 0, candidates = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a.features[i].octave != 0 || a.features[i].raw_px.x() > 600 || a.features[i].raw_px.y() > 440) continue;
    ++candidates;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const Eigen::Vector2f shift = b.features[j].raw_px - a.features[i].raw_px;
      if ((shift - Eigen::Vector2f(6, 4)).norm() < 1.5F && b.features[j].octave == 0 &&
          descriptorDistance(a.descriptors.ptr(static_cast<int>(i)), b.descriptors.ptr(static_cast<int>(j))) < 20) {
        ++repeated;
        break;
      }
    }
  }
  // Cells and their neighbours shift against the image, so that some of the weaker corners change; chance would be 1 %.
  EXPECT_GT(repeated, candidates * 6 / 10) << "of " << candidates;
}

TEST(OrbExtractor, DropsDynamicRegionsAndWeighsDoubtfulOnes) {
  const RgbdFrame frame = texturedFrame();
  cv::Mat1b dynamic(480, 640, std::uint8_t{0});
  dynamic.colRange(0, 200) = 255;
  dynamic.colRange(200, 320) = 51;
  for (const Feature& feature : OrbExtractor(OrbConfig()).extract(frame, dynamic).features) {
    EXPECT_GE(feature.raw_px.x(), 199.0F);
    if (std::abs(feature.raw_px.x() - 320.0F) <= 2.0F) continue;  // the mask's edge
    EXPECT_NEAR(feature.static_weight, feature.raw_px.x() < 320.0F ? 0.8F : 1.0F, 1e-3F);
  }
}

TEST(OrbExtractor, AMaskOverEverythingLeavesTheLeastDynamicFeatures) {
  cv::Mat1b dynamic(480, 640, std::uint8_t{250});
  dynamic.colRange(500, 640) = 150;
  const FrameFeatures found = OrbExtractor(OrbConfig()).extract(texturedFrame(), dynamic);
  ASSERT_EQ(found.size(), 200U);
  for (const Feature& feature : found.features) {
    EXPECT_GT(feature.raw_px.x(), 495.0F);
    EXPECT_NEAR(feature.static_weight, 1.0F - 150.0F / 255.0F, 1e-3F);
  }
}

TEST(OrbExtractor, AnImageWithoutTextureGivesNothing) {
  const RgbdFrame frame =
      makeRgbdFrame(0, Stamp{1}, cv::Mat(480, 640, CV_8UC1, cv::Scalar(90)), cv::Mat(480, 640, CV_32FC1, cv::Scalar(1)),
                    0.001, std::make_shared<CameraModel>(CameraIntrinsics()));
  EXPECT_EQ(OrbExtractor(OrbConfig()).extract(frame, {}).size(), 0U);
}

TEST(OrbExtractor, RefusesAConfigOutOfRange) {
  OrbConfig config;
  config.features = 3;
  EXPECT_THROW(OrbExtractor{config}, ConfigError);
}

}  // namespace
}  // namespace semantic_vslam
