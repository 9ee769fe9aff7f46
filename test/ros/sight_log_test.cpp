// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/sight_log.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace semantic_vslam {
namespace {

constexpr double kPeriodS = 1.0 / 30.0;

/// Frames of one stream, 30 a second, and the lines that they made.
class Frames {
 public:
  void give(TrackingState state, double seconds = kPeriodS) {
    for (int i = 0; i < static_cast<int>(seconds / kPeriodS + 0.5); ++i) {
      output.tracking.state = state;
      output.map = std::make_shared<MapSnapshot>(map);
      if (const auto line = log_.next(Stamp::fromSeconds(now_s_), output)) lines.push_back(*line);
      now_s_ += kPeriodS;
      output.tracking.relocalised = output.new_world = output.is_keyframe = false;
    }
  }
  std::string last() const { return lines.empty() ? "" : lines.back().text; }
  bool lastHas(const std::string& words) const { return last().find(words) != std::string::npos; }

  TrackingOutput output;
  MapSnapshot map;
  std::vector<SightLog::Line> lines;

 private:
  SightLog log_;
  double now_s_ = 1000.0;
};

class SightLogTest : public ::testing::Test {
 protected:
  SightLogTest() {
    frames.map.map_id = 7;
    frames.map.poses.resize(12);
    frames.output.tracking.features = 800;
    frames.give(TrackingState::kInitialising, 1.0);
    frames.give(TrackingState::kOk, 10.0);
  }
  Frames frames;
};

TEST_F(SightLogTest, TheBeginningIsOneLine) {
  ASSERT_EQ(frames.lines.size(), 1U);
  EXPECT_EQ(frames.last(), "tracking begins in a new map");
}

TEST_F(SightLogTest, ALossAndItsEndAreOneLineEachWithTheTimeAndTheWay) {
  frames.give(TrackingState::kRecentlyLost, 1.0);
  EXPECT_EQ(frames.lines.size(), 1U) << "the motion model still carries the pose";
  frames.give(TrackingState::kLost, 3.0);
  ASSERT_EQ(frames.lines.size(), 2U);
  EXPECT_EQ(frames.lines.back().level, LogLevel::kWarning);
  EXPECT_TRUE(frames.lastHas("lost its place 1.0 s ago: 800 features")) << frames.last();
  frames.output.tracking.relocalised = true;
  frames.give(TrackingState::kOk, 1.0);
  ASSERT_EQ(frames.lines.size(), 3U);
  EXPECT_EQ(frames.lines.back().level, LogLevel::kInfo);
  EXPECT_EQ(frames.last(), "tracking has found its place in the map of 12 keyframes after 4.0 s by relocalisation");
}

TEST_F(SightLogTest, FewFeaturesAreSaid) {
  frames.output.tracking.features = 12;
  frames.give(TrackingState::kLost, 1.0);
  EXPECT_TRUE(frames.lastHas("12 features, too few to know a place by")) << frames.last();
}

TEST_F(SightLogTest, WhoTracksOnOrJoinsHisMapIsToldApart) {
  frames.give(TrackingState::kLost, 1.0);
  frames.give(TrackingState::kOk, 10.0);
  EXPECT_TRUE(frames.lastHas("after 1.0 s where it was lost")) << frames.last();
  frames.give(TrackingState::kLost, 6.0);
  frames.output.is_keyframe = true;
  frames.give(TrackingState::kLost, 6.0);
  frames.give(TrackingState::kOk);
  EXPECT_TRUE(frames.lastHas("after 12.0 s: the map that it began meanwhile is joined")) << frames.last();
}

TEST_F(SightLogTest, AFlickeringStateIsNoStormOfLines) {
  for (int i = 0; i < 150; ++i) {
    frames.give(TrackingState::kLost);
    frames.give(TrackingState::kOk);
  }
  EXPECT_LE(frames.lines.size(), 6U) << "two in five seconds, of ten, and the beginning";
  frames.give(TrackingState::kLost, 1.5);
  EXPECT_TRUE(frames.lastHas("lost its place")) << "what lasts is said";
}

TEST_F(SightLogTest, ALoadedMapIsSearchedNotLost) {
  frames.map.map_id = 8;
  frames.map.origin = 3;
  frames.give(TrackingState::kLost, 2.0);
  ASSERT_EQ(frames.lines.size(), 2U);
  EXPECT_EQ(frames.lines.back().level, LogLevel::kInfo);
  EXPECT_TRUE(frames.lastHas("looked for in the map of 12 keyframes")) << frames.last();
  frames.output.tracking.relocalised = true;
  frames.give(TrackingState::kOk);
  EXPECT_TRUE(frames.lastHas("found its place in the map of 12 keyframes after 2.0 s")) << frames.last();
}

TEST_F(SightLogTest, AMapThatWasTooSmallToKeepIsSaid) {
  frames.give(TrackingState::kLost, 2.0);
  frames.map.map_id = 8;
  frames.output.new_world = true;
  frames.give(TrackingState::kOk);
  EXPECT_TRUE(frames.lastHas("goes on after 2.0 s in a new map")) << frames.last();
}

TEST_F(SightLogTest, AResetIsNoLoss) {
  frames.give(TrackingState::kLost, 2.0);
  const std::size_t before = frames.lines.size();
  frames.map.map_id = 8;
  frames.give(TrackingState::kInitialising, 1.0);
  frames.give(TrackingState::kOk, 1.0);
  ASSERT_EQ(frames.lines.size(), before + 1);
  EXPECT_EQ(frames.last(), "tracking begins in a new map");
}

}  // namespace
}  // namespace semantic_vslam
