// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/other_parents.h"

#include <gtest/gtest.h>

namespace semantic_vslam {
namespace {

tf2_msgs::TFMessage edge(const std::string& parent, const std::string& child) {
  tf2_msgs::TFMessage message;
  message.transforms.resize(1);
  message.transforms[0].header.frame_id = parent;
  message.transforms[0].child_frame_id = child;
  return message;
}

TEST(OtherParents, KnowsWhoseFrameItWouldTakeAway) {
  OtherParents parents("map");
  EXPECT_EQ(parents.of("camera_optical"), "");
  parents.take(edge("camera_link", "/camera_optical"));  // old publishers write a slash
  EXPECT_EQ(parents.of("camera_optical"), "camera_link");
  EXPECT_EQ(parents.of("camera_link"), "") << "the root of the driver's own tree may be hung below the map";
}

TEST(OtherParents, ItsOwnEdgeIsNoOtherParent) {
  OtherParents parents("map");
  parents.take(edge("map", "base_link"));
  parents.take(edge("/map", "base_link"));
  EXPECT_EQ(parents.of("base_link"), "");
  parents.take(edge("odom", "base_link"));
  parents.take(edge("map", "base_link"));
  EXPECT_EQ(parents.of("base_link"), "odom") << "also when it was sent already";
}

}  // namespace
}  // namespace semantic_vslam
