// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/segmentation/label_upsampling.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "core/common/rng.h"

namespace semantic_vslam {
namespace {

/// Planar scores of 5 classes on a 9x7 grid.
struct RandomScores {
  static constexpr int kClasses = 5;
  const cv::Size size{9, 7};
  std::vector<cv::Mat1f> planes;
  std::vector<float> nchw, nhwc;

  RandomScores() {
    Rng rng(3);
    for (int k = 0; k < kClasses; ++k) {
      planes.emplace_back(size);
      for (float& value : planes.back()) value = static_cast<float>(rng.normal());
      cv::GaussianBlur(planes.back(), planes.back(), {3, 3}, 1.0);
    }
    nhwc.resize(size.area() * kClasses);
    for (int k = 0; k < kClasses; ++k) {
      nchw.insert(nchw.end(), planes[k].begin(), planes[k].end());
      for (int i = 0; i < size.area(); ++i) nhwc[i * kClasses + k] = nchw[k * size.area() + i];
    }
  }
  LogitGrid planar() const { return {nchw.data(), kClasses, size, static_cast<std::size_t>(size.area()), 1}; }
  LogitGrid interleaved() const { return {nhwc.data(), kClasses, size, 1, kClasses}; }
};

TEST(UpsampleBestLabels, EqualsArgmaxOfBilinearlyUpsampledScores) {
  const RandomScores scores;
  const cv::Size size(72, 56);
  std::vector<cv::Mat1f> large(RandomScores::kClasses);
  for (int k = 0; k < RandomScores::kClasses; ++k) cv::resize(scores.planes[k], large[k], size, 0, 0, cv::INTER_LINEAR);
  const cv::Mat1b labels = upsampleBestLabels(scores.planar(), {0, 0, 9, 7}, size, {10, 11, 12, 13, 14});
  int differ = 0;
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      int best = 0;
      for (int k = 1; k < RandomScores::kClasses; ++k) {
        if (large[k](v, u) > large[best](v, u)) best = k;
      }
      differ += labels(v, u) != best + 10;
    }
  }
  EXPECT_LE(differ, 2);  // rounding may decide a tie the other way
}

TEST(UpsampleBestLabels, TakesBothLayouts) {
  const RandomScores scores;
  const std::vector<std::uint8_t> lut{0, 1, 2, 3, 4};
  const cv::Mat1b a = upsampleBestLabels(scores.planar(), {0, 0, 9, 7}, {30, 20}, lut);
  const cv::Mat1b b = upsampleBestLabels(scores.interleaved(), {0, 0, 9, 7}, {30, 20}, lut);
  EXPECT_EQ(cv::countNonZero(a != b), 0);
}

TEST(UpsampleBestLabels, ShowsOnlyTheRegionOfALetterbox) {
  // Class 1 wins in the left half of the grid, which is all that the region shows.
  const std::vector<float> scores{0, 0, 0, 0, 1, 1, -1, -1};
  const LogitGrid grid{scores.data(), 2, {4, 1}, 4, 1};
  const cv::Mat1b labels = upsampleBestLabels(grid, {0, 0, 1.5, 1}, {10, 3}, {0, 1});
  EXPECT_EQ(cv::countNonZero(labels == 1), 30);
}

TEST(UpsampleLikely, AddsTheClassesOfTheLabelAndComparesBetweenCells) {
  // Softmax of (0, 0, ln 2) is (1/4, 1/4, 1/2): the first two together are as likely as the third; right, by far less.
  const std::vector<float> scores{0, 0, 0, 0, 0.693147F, 10};
  const LogitGrid grid{scores.data(), 3, {2, 1}, 2, 1};
  const auto widthOf = [&grid](float least) {
    return cv::countNonZero(upsampleLikely(grid, {0, 0, 2, 1}, {40, 1}, {1, 1, 2}, 1, least));
  };
  EXPECT_EQ(widthOf(0.501F), 0);
  EXPECT_EQ(widthOf(0.499F), 10);  // up to the first cell's centre
  EXPECT_EQ(widthOf(0.25F), 20);   // half way
  EXPECT_EQ(widthOf(1e-6F), 40);
}

TEST(UpsampleLikely, TakesBothLayoutsAndScoresOfAnySize) {
  const RandomScores scores;
  const std::vector<std::uint8_t> lut{0, 1, 2, 3, 4};
  const cv::Mat1b a = upsampleLikely(scores.planar(), {0, 0, 9, 7}, {30, 20}, lut, 2, 0.2F);
  const cv::Mat1b b = upsampleLikely(scores.interleaved(), {0, 0, 9, 7}, {30, 20}, lut, 2, 0.2F);
  EXPECT_EQ(cv::countNonZero(a != b), 0);
  EXPECT_GT(cv::countNonZero(a), 0);
  EXPECT_LT(cv::countNonZero(a), 600);
  const std::vector<float> huge{1000, -1000};  // overflows a softmax that does not take the largest off
  EXPECT_EQ(upsampleLikely({huge.data(), 2, {1, 1}, 1, 1}, {0, 0, 1, 1}, {1, 1}, {0, 1}, 0, 0.9F)(0), 255);
}

TEST(UpsampleLabels, TakesTheNearestCell) {
  const cv::Mat1b labels = (cv::Mat1b(1, 3) << 1, 2, 3);
  const cv::Mat1b whole = upsampleLabels(labels, {0, 0, 3, 1}, {6, 2});
  EXPECT_EQ(cv::Mat1b(whole.row(1)).at<std::uint8_t>(0), 1);
  const std::vector<int> row(whole.ptr(1), whole.ptr(1) + 6);
  EXPECT_EQ(row, (std::vector<int>{1, 1, 2, 2, 3, 3}));
  const cv::Mat1b part = upsampleLabels(labels, {0, 0, 2, 1}, {4, 1});
  EXPECT_EQ(std::vector<int>(part.ptr(0), part.ptr(0) + 4), (std::vector<int>{1, 1, 2, 2}));
}

}  // namespace
}  // namespace semantic_vslam
