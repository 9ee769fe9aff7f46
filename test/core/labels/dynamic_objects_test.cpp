// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/labels/dynamic_objects.h"

#include "core/support/fixtures.h"

namespace semantic_vslam {
namespace {

const LabelSet kOffice = officeLabels();
constexpr std::uint8_t kPerson = 1, kChair = 2, kTable = 3;

/// A 10x10 image with a chair of 4x5 pixels at (1, 2).
cv::Mat1b chairImage(std::uint8_t label = kChair) {
  cv::Mat1b labels(10, 10, std::uint8_t{0});
  labels(cv::Rect(1, 2, 4, 5)).setTo(label);
  return labels;
}

TEST(DecideDynamic, TakesTheShareOfMovingPixelsOfEachMask) {
  cv::Mat1b moving(10, 10, std::uint8_t{0});
  moving(cv::Rect(0, 0, 3, 10)).setTo(200);  // 2 of the chair's 4 columns
  moving(cv::Rect(3, 2, 1, 5)).setTo(127);   // below the threshold: does not move
  const auto objects = decideDynamic(chairImage(), kOffice, moving, 0.4, nullptr);
  ASSERT_EQ(objects.size(), 1U);
  EXPECT_EQ(objects[0].label, kChair);
  EXPECT_EQ(objects[0].mask_px, 20);
  EXPECT_EQ(objects[0].box, cv::Rect(1, 2, 4, 5));
  EXPECT_DOUBLE_EQ(objects[0].dynamic_share, 10.0 / 20.0);
  EXPECT_TRUE(objects[0].moving);
  EXPECT_TRUE(objects[0].removed);
}

TEST(DecideDynamic, NeedsMoreThanPhi) {
  cv::Mat1b moving(10, 10, std::uint8_t{0});
  moving(cv::Rect(0, 0, 3, 10)).setTo(255);
  cv::Mat1b removal;
  EXPECT_FALSE(decideDynamic(chairImage(), kOffice, moving, 0.5, &removal)[0].moving);  // exactly phi
  EXPECT_EQ(cv::countNonZero(removal), 0);
  EXPECT_TRUE(decideDynamic(chairImage(), kOffice, moving, 0.49, &removal)[0].moving);
  EXPECT_EQ(cv::countNonZero(removal == 255), 20);
  EXPECT_EQ(removal(2, 1), 255);
}

TEST(DecideDynamic, RemovesPeopleWhetherTheyMoveOrNot) {
  cv::Mat1b removal;
  const auto objects = decideDynamic(chairImage(kPerson), kOffice, cv::Mat1b(), 0.4, &removal);
  EXPECT_FALSE(objects[0].moving);
  EXPECT_TRUE(objects[0].removed);
  EXPECT_EQ(cv::countNonZero(removal), 20);
}

TEST(DecideDynamic, NeverRemovesStaticThings) {
  const cv::Mat1b moving(10, 10, std::uint8_t{255});
  cv::Mat1b removal;
  const auto objects = decideDynamic(chairImage(kTable), kOffice, moving, 0.4, &removal);
  EXPECT_TRUE(objects[0].moving);
  EXPECT_FALSE(objects[0].removed);
  EXPECT_EQ(cv::countNonZero(removal), 0);
}

TEST(DecideDynamic, JudgesTwoMasksOfOneClassApart) {
  cv::Mat1b labels = chairImage();
  labels(cv::Rect(7, 2, 2, 2)).setTo(kChair);
  cv::Mat1b moving(10, 10, std::uint8_t{0});
  moving.colRange(6, 10).setTo(255);
  cv::Mat1b removal;
  const auto objects = decideDynamic(labels, kOffice, moving, 0.4, &removal);
  ASSERT_EQ(objects.size(), 2U);
  EXPECT_FALSE(objects[0].removed);
  EXPECT_TRUE(objects[1].removed);
  EXPECT_EQ(cv::countNonZero(removal), 4);
}

TEST(DecideDynamic, FindsNothingInAnEmptyImage) {
  cv::Mat1b removal;
  EXPECT_TRUE(decideDynamic(cv::Mat1b::zeros(4, 4), kOffice, cv::Mat1b(), 0.4, &removal).empty());
  EXPECT_EQ(removal.size(), cv::Size(4, 4));
  EXPECT_EQ(cv::countNonZero(removal), 0);
}

TEST(MaskOfPeople, LeavesOutThingsAndUnknownLabels) {
  const cv::Mat1b people = maskOfPeople((cv::Mat1b(1, 5) << 0, 1, 2, 3, 200), kOffice);
  EXPECT_EQ(std::vector<int>(people.ptr(), people.ptr() + 5), (std::vector<int>{0, 255, 0, 0, 0}));
}

}  // namespace
}  // namespace semantic_vslam
