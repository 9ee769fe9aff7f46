// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "semantic_vslam/core/segmentation/connected_regions.h"

#include <gtest/gtest.h>

namespace semantic_vslam {
namespace {

/// Regions of equal letters; '.' belongs to none.
ConnectedRegions regionsOf(const std::vector<std::string>& rows) {
  std::string all;
  for (const auto& row : rows) all += row;
  const cv::Size size(static_cast<int>(rows[0].size()), static_cast<int>(rows.size()));
  std::vector<cv::Point> pixels;
  for (int i = 0; i < size.area(); ++i) {
    if (all[i] != '.') pixels.emplace_back(i % size.width, i / size.width);
  }
  ConnectedRegions regions;
  connectRegions(
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

TEST(ConnectRegions, FindsNothingInNothing) { EXPECT_EQ(regionsOf({"..", ".."}).count, 0); }

}  // namespace
}  // namespace semantic_vslam
