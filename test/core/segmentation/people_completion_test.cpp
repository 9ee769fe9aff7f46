// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/segmentation/people_completion.h"

#include "core/support/fixtures.h"
#include "semantic_vslam/core/segmentation/segmenter.h"

namespace semantic_vslam {
namespace {

constexpr std::uint8_t kPerson = 1, kChair = 2;
const cv::Size kSize(120, 90);
const cv::Rect kBody(30, 15, 45, 60);

/// A body at 1 m before a wall; its upper part is certain, and around all of it, and of the wall, a person is likely.
struct Scene {
  cv::Mat1f depth_m{kSize, 3.0F};
  Segmentation segmentation{cv::Mat1b(kSize, std::uint8_t{0}), cv::Mat1b(kSize, std::uint8_t{0})};

  explicit Scene(int certain_rows) {
    depth_m(kBody).setTo(1.0F);
    segmentation.weak_people(cv::Rect(kBody.x - 9, kBody.y - 9, kBody.width + 18, kBody.height + 18)).setTo(255);
    segmentation.labels(cv::Rect(kBody.x, kBody.y, kBody.width, certain_rows)).setTo(kPerson);
  }
  cv::Mat1b complete(int stride_px = 1) const {
    cv::Mat1b labels = segmentation.labels.clone();
    PeopleCompletion(stride_px, 0.4).complete(labels, segmentation.weak_people, kPerson, frameOf(depth_m));
    return labels;
  }
};

cv::Mat1b bodyAlone() {
  cv::Mat1b labels(kSize, std::uint8_t{0});
  labels(kBody).setTo(kPerson);
  return labels;
}

int differing(const cv::Mat1b& a, const cv::Mat1b& b) { return cv::countNonZero(a != b); }

TEST(PeopleCompletion, TakesTheWholeSurfaceAndNothingBehindIt) {
  EXPECT_EQ(differing(Scene(30).complete(), bodyAlone()), 0);
  EXPECT_EQ(differing(Scene(30).complete(3), bodyAlone()), 0);  // the body's sides are multiples of 3
}

TEST(PeopleCompletion, LeavesASurfaceThatIsMostlySomethingElse) {
  const Scene scene(20);  // a third
  EXPECT_EQ(differing(scene.complete(), scene.segmentation.labels), 0);
}

TEST(PeopleCompletion, TakesOtherLabelsButOnlyWhereAPersonIsLikely) {
  Scene scene(30);
  scene.segmentation.labels(cv::Rect(kBody.x, kBody.y + 40, 10, 5)).setTo(kChair);
  EXPECT_EQ(differing(scene.complete(), bodyAlone()), 0);
  const cv::Rect bag(kBody.x, kBody.y + 40, 10, 5);
  scene.segmentation.weak_people(bag).setTo(0);
  const cv::Mat1b completed = scene.complete();
  EXPECT_EQ(cv::countNonZero(completed(bag) == kChair), bag.area());
  EXPECT_EQ(cv::countNonZero(completed == kPerson), kBody.area() - bag.area());
}

TEST(PeopleCompletion, LeavesHolesOfTheDepthAsTheyAre) {
  Scene scene(30);
  const cv::Rect hole(kBody.x + 10, kBody.y + 40, 12, 9);
  scene.depth_m(hole).setTo(0.0F);
  const cv::Mat1b completed = scene.complete();
  EXPECT_EQ(cv::countNonZero(completed(hole)), 0);
  EXPECT_EQ(cv::countNonZero(completed == kPerson), kBody.area() - hole.area());
}

TEST(PeopleCompletion, FollowsASurfaceTurnedAwayAndTheQuantaOfAFarOne) {
  Scene scene(30);
  for (int u = 0; u < kBody.width; ++u) {  // 45 degrees: a pixel is as deep as it is wide
    scene.depth_m(kBody).col(u).setTo(1.0F +
                                      static_cast<float>(u) / static_cast<float>(frameOf(scene.depth_m).camera->fx()));
  }
  EXPECT_EQ(differing(scene.complete(), bodyAlone()), 0);
  scene.depth_m.setTo(7.0F);
  for (int v = 0; v < kBody.height; v += 2) scene.depth_m(kBody).row(v).setTo(4.0F);
  for (int v = 1; v < kBody.height; v += 2) scene.depth_m(kBody).row(v).setTo(4.0F + 0.99F * 2.85e-3F * 16.0F);
  EXPECT_EQ(differing(scene.complete(), bodyAlone()), 0);
}

}  // namespace
}  // namespace semantic_vslam
