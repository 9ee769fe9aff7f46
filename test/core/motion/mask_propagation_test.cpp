// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/motion/mask_propagation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "core/motion/flow_carry.h"

namespace semantic_vslam {
namespace {

constexpr int kWidth = 40, kHeight = 30, kCellPx = 4;
constexpr std::uint8_t kPerson = 1, kChair = 2;

LabelSet labelSet() {
  LabelSet set;
  set.classes.push_back({"person", Mobility::kPerson, {}});
  set.classes.push_back({"chair", Mobility::kMovable, {}});
  return set;
}

cv::Mat1f evenDepth() { return cv::Mat1f(kHeight, kWidth, 2.0F); }

/// Source of a flow that is the same everywhere.
cv::Mat2f shift(float u, float v, const cv::Mat1f& previous_depth_m = evenDepth()) {
  return traceBack(cv::Mat2f(kHeight, kWidth, cv::Vec2f(u, v)), previous_depth_m, evenDepth(), 0.03);
}

void addFrame(MaskPropagation& propagation, double seconds, const cv::Mat2f& source) {
  propagation.addFrame(Stamp::fromSeconds(seconds), {kWidth, kHeight}, source);
}

cv::Mat1b labelsWithBlock(std::uint8_t label, const cv::Rect& cells) {
  cv::Mat1b labels = cv::Mat1b::zeros(kHeight * kCellPx, kWidth * kCellPx);
  labels(cv::Rect(cells.x * kCellPx, cells.y * kCellPx, cells.width * kCellPx, cells.height * kCellPx)) = label;
  return labels;
}

TEST(MaskPropagationTest, CarriesALateMaskAlongTheFlow) {
  MaskPropagation propagation{MaskPropagationConfig()};
  addFrame(propagation, 0.0, {});
  for (int i = 1; i <= 5; ++i) addFrame(propagation, 0.03 * i, shift(2.0F, -1.0F));
  EXPECT_FALSE(propagation.hasMask());
  ASSERT_TRUE(propagation.addLabels(Stamp::fromSeconds(0.0), labelsWithBlock(kPerson, {10, 12, 6, 8}), labelSet()));
  const cv::Mat1f dynamic = propagation.dynamicNow();
  EXPECT_GT(dynamic(7 + 4, 20 + 3), 0.9F);  // block moved by (10, -5)
  EXPECT_LT(dynamic(16, 12), 0.1F);         // where it was
  // One more frame goes on from there.
  addFrame(propagation, 0.18, shift(2.0F, -1.0F));
  EXPECT_GT(propagation.dynamicNow()(6 + 4, 22 + 3), 0.9F);
}

TEST(MaskPropagationTest, DoesNotBlurWithTheNumberOfFrames) {
  MaskPropagation propagation{MaskPropagationConfig()};
  addFrame(propagation, 0.0, {});
  ASSERT_TRUE(propagation.addLabels(Stamp::fromSeconds(0.0), labelsWithBlock(kPerson, {10, 12, 6, 8}), labelSet()));
  for (int i = 1; i <= 30; ++i) addFrame(propagation, 0.033 * i, shift(0.3F, 0.0F));
  const cv::Mat1f dynamic = propagation.dynamicNow();  // block now at x 19 .. 25
  EXPECT_LT(dynamic(16, 17), 0.3F);
  EXPECT_GT(dynamic(16, 20), 0.7F);
  EXPECT_GT(dynamic(16, 23), 0.7F);
  EXPECT_LT(dynamic(16, 26), 0.3F);
}

TEST(MaskPropagationTest, LosesTheMaskWhereBackgroundIsUncovered) {
  MaskPropagation propagation{MaskPropagationConfig()};
  cv::Mat1f near = evenDepth();
  near(cv::Rect(10, 10, 10, 10)) = 1.0F;
  addFrame(propagation, 0.0, {});
  ASSERT_TRUE(propagation.addLabels(Stamp::fromSeconds(0.0), labelsWithBlock(kPerson, {10, 10, 10, 10}), labelSet()));
  addFrame(propagation, 0.03, shift(0.0F, 0.0F, near));
  EXPECT_TRUE(std::isnan(propagation.dynamicNow()(15, 15)));
}

TEST(MaskPropagationTest, LosesTheMaskWhereAHoleIsUncovered) {
  MaskPropagation propagation{MaskPropagationConfig()};
  cv::Mat1f black_screen = evenDepth(), near = evenDepth();
  near(cv::Rect(10, 10, 10, 10)) = 1.0F;
  black_screen(cv::Rect(10, 10, 10, 10)) = 0.0F;
  addFrame(propagation, 0.0, {});
  ASSERT_TRUE(propagation.addLabels(Stamp::fromSeconds(0.0), labelsWithBlock(kPerson, {0, 0, 30, 30}), labelSet()));
  const cv::Mat2f at_rest(kHeight, kWidth, cv::Vec2f(0.0F, 0.0F));
  addFrame(propagation, 0.03, traceBack(at_rest, near, evenDepth(), 0.03));
  EXPECT_TRUE(std::isnan(propagation.dynamicNow()(15, 15))) << "who stood before the screen has gone";
  EXPECT_GT(propagation.dynamicNow()(5, 5), 0.9F);
  ASSERT_TRUE(propagation.addLabels(Stamp::fromSeconds(0.03), labelsWithBlock(kPerson, {0, 0, 30, 30}), labelSet()));
  addFrame(propagation, 0.06, traceBack(at_rest, black_screen, evenDepth(), 0.03));
  addFrame(propagation, 0.09, traceBack(at_rest, evenDepth(), evenDepth(), 0.03));
  EXPECT_GT(propagation.dynamicNow()(15, 15), 0.9F)
      << "holes that stay and such as flicker, in dark clothes, are carried";
}

TEST(MaskPropagationTest, TrustFadesWithTheConfiguredTime) {
  MaskPropagationConfig config;
  config.time_constant_s = 0.5;
  MaskPropagation propagation(config);
  addFrame(propagation, 0.0, {});
  ASSERT_TRUE(propagation.addLabels(Stamp::fromSeconds(0.0), labelsWithBlock(kPerson, {10, 10, 10, 10}), labelSet()));
  addFrame(propagation, 0.5, shift(0.0F, 0.0F));
  EXPECT_NEAR(propagation.dynamicNow()(15, 15), 0.5 + 0.5 * std::exp(-1.0), 1e-3);
  addFrame(propagation, 1.6, shift(0.0F, 0.0F));
  EXPECT_FALSE(propagation.hasMask());
}

TEST(MaskPropagationTest, MovableThingsCountOnlyIfEnoughOfThemMoved) {
  MaskPropagation propagation{MaskPropagationConfig()};  // phi = 0.4
  addFrame(propagation, 0.0, {});
  cv::Mat1b labels = labelsWithBlock(kChair, {2, 2, 10, 10});
  labels.setTo(kChair, labelsWithBlock(kChair, {20, 2, 10, 10}) == kChair);
  cv::Mat1b moving(kHeight, kWidth, static_cast<uchar>(0));
  moving(cv::Rect(2, 2, 10, 5)) = 255;   // rho = 0.5
  moving(cv::Rect(20, 2, 10, 2)) = 255;  // rho = 0.2
  propagation.setMoving(moving);
  ASSERT_TRUE(propagation.addLabels(Stamp::fromSeconds(0.0), labels, labelSet()));
  const cv::Mat1f dynamic = propagation.dynamicNow();
  EXPECT_GT(dynamic(10, 7), 0.9F);
  EXPECT_LT(dynamic(10, 25), 0.1F);
}

TEST(MaskPropagationTest, IgnoresLabelsOfFramesItDoesNotKnow) {
  MaskPropagationConfig config;
  config.max_delay_s = 1.0;
  MaskPropagation propagation(config);
  const cv::Mat1b labels = labelsWithBlock(kPerson, {10, 10, 10, 10});
  EXPECT_FALSE(propagation.addLabels(Stamp::fromSeconds(0.0), labels, labelSet()));
  addFrame(propagation, 0.0, {});
  addFrame(propagation, 1.2, shift(0.0F, 0.0F));
  EXPECT_FALSE(propagation.addLabels(Stamp::fromSeconds(0.0), labels, labelSet()));  // too late
  EXPECT_FALSE(propagation.addLabels(Stamp::fromSeconds(0.6), labels, labelSet()));  // never seen
  EXPECT_TRUE(propagation.addLabels(Stamp::fromSeconds(1.2), labels, labelSet()));
}

TEST(MaskPropagationTest, LabelsAreWeighedOnlyWhereTheFramesPlaceIsKnown) {
  MaskPropagation propagation{MaskPropagationConfig()};
  const auto placeAt = [](double seconds) {
    return PlacedFrame{Stamp::fromSeconds(seconds), evenDepth(), evenDepth(), SE3::Identity()};
  };
  std::vector<double> asked;
  const auto nobody = [&](const cv::Mat1f& dynamic, const PlacedFrame& place) {
    asked.push_back(place.stamp.seconds());
    return cv::Mat1f(dynamic.size(), 0.0F);
  };
  const auto personSeen = [&](double seconds) {
    const cv::Mat1b labels = labelsWithBlock(kPerson, {10, 10, 10, 10});
    EXPECT_TRUE(propagation.addLabels(Stamp::fromSeconds(seconds), labels, labelSet(), nobody));
    return propagation.dynamicNow()(15, 15) > 0.9F;
  };
  addFrame(propagation, 0.0, {});
  EXPECT_TRUE(personSeen(0.0)) << "no place is known";
  addFrame(propagation, 0.1, shift(0.0F, 0.0F));
  propagation.setPlace(placeAt(0.1));
  addFrame(propagation, 0.2, shift(0.0F, 0.0F));
  propagation.setPlace(placeAt(0.2));
  EXPECT_FALSE(personSeen(0.1)) << "what is weighed is believed";
  propagation.forgetPlaces();
  EXPECT_TRUE(personSeen(0.2));
  EXPECT_EQ(asked, std::vector<double>{0.1});
}

}  // namespace
}  // namespace semantic_vslam
