// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/features/matcher.h"

#include <gtest/gtest.h>

#include "core/common/rng.h"

namespace semantic_vslam {
namespace {

cv::Mat1b randomDescriptor(Rng& rng) {
  cv::Mat1b descriptor(1, 32);
  for (auto& byte : descriptor) byte = static_cast<std::uint8_t>(rng.below(256));
  return descriptor;
}

void addFeature(FrameFeatures& frame, float u_px, float v_px, const cv::Mat1b& descriptor, float depth_m = 1.0F,
                float angle_rad = 0.0F) {
  Feature feature;
  feature.raw_px = feature.undistorted_px = {u_px, v_px};
  feature.depth_m = depth_m;
  feature.angle_rad = angle_rad;
  frame.features.push_back(feature);
  frame.descriptors.push_back(descriptor);
}

GuidedQuery queryAt(float u_px, float v_px, float radius_px, const cv::Mat1b& descriptor) {
  GuidedQuery query;
  query.descriptor = descriptor.ptr();
  query.predicted_px = {u_px, v_px};
  query.radius_px = radius_px;
  return query;
}

TEST(DescriptorDistance, CountsBits) {
  cv::Mat1b a(1, 32, std::uint8_t{0}), b(1, 32, std::uint8_t{0});
  EXPECT_EQ(descriptorDistance(a.ptr(), b.ptr()), 0);
  b(0, 3) = 0x0F;
  b(0, 31) = 0x80;
  EXPECT_EQ(descriptorDistance(a.ptr(), b.ptr()), 5);
  b.setTo(255);
  EXPECT_EQ(descriptorDistance(a.ptr(), b.ptr()), 256);
}

class GuidedSearch : public ::testing::Test {
 protected:
  std::vector<FeatureMatch> search(const std::vector<GuidedQuery>& queries, const GuidedSearchConfig& config = {}) {
    return searchGuided(queries, frame_, FeatureGrid(frame_, 640, 480), taken_, config);
  }
  Rng rng_{7};
  FrameFeatures frame_;
  std::vector<bool> taken_;
};

TEST_F(GuidedSearch, FindsOnlyWithinTheRadius) {
  const cv::Mat1b descriptor = randomDescriptor(rng_);
  addFeature(frame_, 100, 100, descriptor);
  EXPECT_EQ(search({queryAt(104, 97, 5, descriptor)}).size(), 1U);
  EXPECT_EQ(search({queryAt(106, 100, 5, descriptor)}).size(), 0U);
  EXPECT_EQ(search({queryAt(100, 100, 5, randomDescriptor(rng_))}).size(), 0U);
}

TEST_F(GuidedSearch, GivesAFeatureToItsClosestQueryOnly) {
  const cv::Mat1b descriptor = randomDescriptor(rng_);
  cv::Mat1b similar = descriptor.clone();
  similar(0, 0) ^= 0xFF;
  addFeature(frame_, 100, 100, descriptor);
  const auto matches = search({queryAt(100, 100, 5, similar), queryAt(100, 100, 5, descriptor)});
  ASSERT_EQ(matches.size(), 1U);
  EXPECT_EQ(matches[0].query, 1);
}

TEST_F(GuidedSearch, RespectsTakenFeaturesOctavesAndDepth) {
  const cv::Mat1b descriptor = randomDescriptor(rng_);
  addFeature(frame_, 100, 100, descriptor, 2.0F);
  GuidedQuery query = queryAt(100, 100, 5, descriptor);
  taken_ = {true};
  EXPECT_EQ(search({query}).size(), 0U);
  taken_.clear();
  query.min_octave = 1;
  EXPECT_EQ(search({query}).size(), 0U);
  query.min_octave = 0;
  GuidedSearchConfig config;
  config.virtual_bf_px_m = 40.0F;
  query.depth_m = 2.2F;  // 40 (1/2 - 1/2.2) = 1.8 px
  EXPECT_EQ(search({query}, config).size(), 1U);
  query.depth_m = 4.0F;  // 40 (1/2 - 1/4) = 10 px > 5
  EXPECT_EQ(search({query}, config).size(), 0U);
}

TEST_F(GuidedSearch, DropsTheMatchThatTurnsAgainstTheMajority) {
  std::vector<GuidedQuery> queries;
  std::vector<cv::Mat1b> descriptors;
  for (int i = 0; i < 20; ++i) descriptors.push_back(randomDescriptor(rng_));
  for (int i = 0; i < 20; ++i) {
    const float u = 20.0F + 30.0F * static_cast<float>(i);
    addFeature(frame_, u, 100, descriptors[i], 1.0F, i == 5 ? 2.5F : 0.1F);
    queries.push_back(queryAt(u, 100, 5, descriptors[i]));
    queries.back().angle_rad = 0.2F;
  }
  const auto matches = search(queries);
  EXPECT_EQ(matches.size(), 19U);
  for (const auto& match : matches) EXPECT_NE(match.query, 5);
}

TEST(BruteForce, MatchesMutuallyAndSkipsTheUnused) {
  Rng rng(9);
  FrameFeatures a, b;
  for (int i = 0; i < 30; ++i) {
    const cv::Mat1b descriptor = randomDescriptor(rng);
    addFeature(a, 0, 0, descriptor);
    addFeature(b, 0, 0, descriptor);
  }
  std::vector<bool> use_a(30, true);
  use_a[4] = false;
  const auto matches = matchBruteForce(a, use_a, b, {}, kMaxDistanceStrict, 0.7F);
  ASSERT_EQ(matches.size(), 29U);
  for (const auto& match : matches) {
    EXPECT_EQ(match.query, match.feature);
    EXPECT_NE(match.query, 4);
  }
}

TEST(BruteForce, RefusesTheAmbiguous) {
  Rng rng(9);
  FrameFeatures a, b;
  const cv::Mat1b descriptor = randomDescriptor(rng);
  addFeature(a, 0, 0, descriptor);
  addFeature(b, 0, 0, descriptor);
  cv::Mat1b twin = descriptor.clone();
  twin(0, 0) ^= 1;
  addFeature(b, 50, 50, twin);
  EXPECT_EQ(matchBruteForce(a, {}, b, {}, kMaxDistanceStrict, 0.7F).size(), 1U) << "distance 0 always beats 1";
  a.descriptors(0, 1) ^= 0x0F;  // now 4 against 5 bits
  EXPECT_EQ(matchBruteForce(a, {}, b, {}, kMaxDistanceStrict, 0.7F).size(), 0U);
}

}  // namespace
}  // namespace semantic_vslam
