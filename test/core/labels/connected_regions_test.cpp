// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/labels/connected_regions.h"

#include <gtest/gtest.h>

#include <random>
#include <string>

namespace semantic_vslam {
namespace {

/// Regions of equal letters; '.' belongs to none.
template <bool kTransitive = false>
ConnectedRegions regionsOf(const std::vector<std::string>& rows) {
  std::string all;
  for (const auto& row : rows) all += row;
  const cv::Size size(static_cast<int>(rows[0].size()), static_cast<int>(rows.size()));
  std::vector<cv::Point> pixels;
  for (int i = 0; i < size.area(); ++i) {
    if (all[i] != '.') pixels.emplace_back(i % size.width, i / size.width);
  }
  ConnectedRegions regions;
  connectRegions<kTransitive>(
      size, pixels, [&](int a, int b) { return all[a] == all[b]; }, regions);
  return regions;
}

TEST(ConnectRegions, JoinsOverCornersAndNumbersByFirstPixel) {
  const ConnectedRegions regions = regionsOf({"a..b",  //
                                              ".a.b",  //
                                              "c.a."});
  EXPECT_EQ(regions.count, 3);
  EXPECT_EQ(regions.size_px, (std::vector<int>{3, 2, 1}));
  EXPECT_EQ(regions.id(0, 0), 0);
  EXPECT_EQ(regions.id(1, 1), 0);
  EXPECT_EQ(regions.id(2, 2), 0);
  EXPECT_EQ(regions.id(1, 3), 1);
  EXPECT_EQ(regions.id(2, 0), 2);
  EXPECT_EQ(regions.id(0, 1), -1);
}

TEST(ConnectRegions, JoinsArmsThatMeetLate) {
  const ConnectedRegions regions = regionsOf({"a.a.a",  //
                                              "a.a.a",  //
                                              "aaaaa"});
  EXPECT_EQ(regions.count, 1);
}

TEST(ConnectRegions, KeepsApartWhatIsNotJoined) { EXPECT_EQ(regionsOf({"abab", "abab"}).count, 4); }

TEST(ConnectRegions, FindsTheSameWhenToldThatEqualityIsTransitive) {
  std::mt19937 random(1);
  for (int k = 0; k < 50; ++k) {
    std::vector<std::string> rows(8, std::string(9, '.'));
    for (auto& row : rows) {
      for (char& letter : row) letter = "ab."[random() % 3];
    }
    const ConnectedRegions all_asked = regionsOf(rows), regions = regionsOf<true>(rows);
    EXPECT_EQ(cv::countNonZero(all_asked.id != regions.id), 0);
    EXPECT_EQ(all_asked.size_px, regions.size_px);
  }
}

TEST(ConnectRegions, FindsNothingInNothing) { EXPECT_EQ(regionsOf({"..", ".."}).count, 0); }

}  // namespace
}  // namespace semantic_vslam
