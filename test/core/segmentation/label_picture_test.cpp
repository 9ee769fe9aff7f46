// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/segmentation/label_picture.h"

#include "core/support/fixtures.h"

namespace semantic_vslam {
namespace {

const LabelSet kOffice = officeLabels();

TEST(LabelColours, GivesEachLabelItsColourAndUnknownOnesBlack) {
  const cv::Mat1b labels = (cv::Mat1b(1, 3) << 0, 2, 77);
  const cv::Mat3b colours = labelColours(labels, kOffice);
  EXPECT_EQ(colours(0, 0), kOffice.classes[0].color_bgr);
  EXPECT_EQ(colours(0, 1), kOffice.classes[2].color_bgr);
  EXPECT_EQ(colours(0, 2), cv::Vec3b(0, 0, 0));
}

TEST(DrawLabels, TintsOnlyWhatIsLabelled) {
  const cv::Mat3b bgr(60, 200, cv::Vec3b(100, 100, 100));
  cv::Mat1b labels(60, 200, std::uint8_t{0});
  labels(cv::Rect(120, 10, 40, 40)).setTo(1);
  const cv::Mat3b picture = drawLabels(bgr, labels, kOffice);
  EXPECT_EQ(picture(5, 190), cv::Vec3b(100, 100, 100));
  EXPECT_GT(picture(30, 140)[2], 120);                       // person: red
  EXPECT_EQ(picture(30, 119), cv::Vec3b(255, 255, 255));     // outline
  EXPECT_EQ(picture(10, 10), kOffice.classes[1].color_bgr);  // legend
}

}  // namespace
}  // namespace semantic_vslam
