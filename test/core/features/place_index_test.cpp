// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/features/place_index.h"

#include <gtest/gtest.h>

#include "core/common/rng.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

/// A place is a set of descriptors; a view of it holds a part of them, with some bits flipped.
class Places {
 public:
  Places(int places, int features, std::uint64_t seed) : rng_(seed), features_(features) {
    for (int p = 0; p < places; ++p) {
      cv::Mat1b descriptors(features, 32);
      for (auto& byte : descriptors) byte = static_cast<std::uint8_t>(rng_.below(256));
      places_.push_back(descriptors);
    }
  }
  FrameFeatures view(int place, double kept, int flipped_bits) {
    FrameFeatures out;
    out.features.resize(features_);
    out.descriptors.create(features_, 32);
    for (int i = 0; i < features_; ++i) {
      for (auto& byte : cv::Mat1b(out.descriptors.row(i))) byte = static_cast<std::uint8_t>(rng_.below(256));
      if (rng_.uniform() >= kept) continue;
      places_[place].row(i).copyTo(out.descriptors.row(i));
      for (int b = 0; b < flipped_bits; ++b) {
        out.descriptors(i, static_cast<int>(rng_.below(32))) ^= static_cast<std::uint8_t>(1U << rng_.below(8));
      }
    }
    return out;
  }

 private:
  Rng rng_;
  int features_;
  std::vector<cv::Mat1b> places_;
};

TEST(PlaceIndex, FindsThePlaceAmongManyFromAPartialNoisyView) {
  constexpr int kPlaces = 200;
  Places places(kPlaces, 400, 1);
  PlaceIndex index;
  for (int p = 0; p < kPlaces; ++p) index.add(KeyframeId(p), places.view(p, 1.0, 0));
  int right = 0;
  for (int p = 0; p < kPlaces; ++p) {
    const auto matches = index.query(places.view(p, 0.4, 20), 1);
    if (!matches.empty() && matches[0].keyframe == KeyframeId(p) && matches[0].votes >= 10) ++right;
  }
  EXPECT_EQ(right, kPlaces);
}

TEST(PlaceIndex, AnUnknownPlaceGetsHardlyAVote) {
  Places places(101, 400, 2);
  PlaceIndex index;
  for (int p = 0; p < 100; ++p) index.add(KeyframeId(p), places.view(p, 1.0, 0));
  for (const auto& match : index.query(places.view(100, 1.0, 0), 10)) EXPECT_LE(match.votes, 2);
}

TEST(PlaceIndex, TheSameViewScoresOneAndVotesOnceAFeature) {
  Places places(1, 300, 3);
  PlaceIndex index;
  const FrameFeatures view = places.view(0, 1.0, 0);
  index.add(KeyframeId(7), view);
  index.add(KeyframeId(8), view);
  const auto matches = index.query(view, 10);
  ASSERT_EQ(matches.size(), 2U);
  EXPECT_EQ(matches[0].keyframe, KeyframeId(7));  // older first among equals
  EXPECT_EQ(matches[0].votes, 300);
  EXPECT_DOUBLE_EQ(matches[0].score, 1.0);
}

TEST(PlaceIndex, RemovedKeyframesAreNeverReturnedAndTheirMemoryComesBack) {
  Places places(60, 300, 4);
  PlaceIndex index;
  std::vector<FrameFeatures> views;
  for (int p = 0; p < 60; ++p) views.push_back(places.view(p, 1.0, 0));
  for (int round = 0; round < 3; ++round) {
    for (int p = 0; p < 60; ++p) index.add(KeyframeId(100 * round + p), views[p]);
    for (int p = 0; p < 60; ++p) {
      if (p % 6 != 0) index.remove(KeyframeId(100 * round + p));
    }
  }
  EXPECT_EQ(index.size(), 30U);
  for (int p = 0; p < 60; ++p) {
    const auto matches = index.query(views[p], 100);
    int strong = 0;
    for (const auto& match : matches) {
      EXPECT_EQ(match.keyframe.value() % 100 % 6, 0U);
      strong += match.votes > 200 ? 1 : 0;
    }
    EXPECT_EQ(strong, p % 6 == 0 ? 3 : 0);
  }
}

TEST(PlaceIndex, FeaturesThatMayMoveDoNotCount) {
  Places places(1, 200, 5);
  PlaceIndex index;
  FrameFeatures view = places.view(0, 1.0, 0);
  index.add(KeyframeId(0), view);
  for (int i = 0; i < 150; ++i) view.features[i].static_weight = 0.1F;
  const auto matches = index.query(view, 1);
  ASSERT_EQ(matches.size(), 1U);
  EXPECT_EQ(matches[0].votes, 50);
  EXPECT_DOUBLE_EQ(matches[0].score, 1.0);
}

TEST(PlaceIndex, EmptyFramesAndAnEmptyIndexGiveNothing) {
  Places places(1, 50, 6);
  PlaceIndex index;
  EXPECT_TRUE(index.query(places.view(0, 1.0, 0), 5).empty());
  index.add(KeyframeId(0), FrameFeatures());
  EXPECT_TRUE(index.query(FrameFeatures(), 5).empty());
  EXPECT_EQ(index.size(), 1U);
  index.clear();
  EXPECT_EQ(index.size(), 0U);
}

TEST(PlaceIndex, RefusesAConfigOutOfRange) {
  PlaceIndexConfig config;
  config.trees = 0;
  EXPECT_THROW(PlaceIndex index(config), ConfigError);
}

TEST(PlaceIndex, FindsItsWayAmongAThousandKeyframes) {
  // Consecutive keyframes share most of their points, as in a map.
  Places places(100, 1000, 7);
  PlaceIndex index;
  for (int k = 0; k < 1000; ++k) index.add(KeyframeId(k), places.view(k / 10, 0.7, 15));
  for (const int place : {3, 50, 97}) {
    EXPECT_EQ(index.query(places.view(place, 0.6, 15), 1)[0].keyframe.value() / 10, static_cast<std::uint64_t>(place));
  }
}

}  // namespace
}  // namespace semantic_vslam
