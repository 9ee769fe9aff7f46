// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/segmentation/depth_refinement.h"

#include <opencv2/imgproc.hpp>

#include "core/support/fixtures.h"

namespace semantic_vslam {
namespace {

constexpr std::uint8_t kPerson = 1, kChair = 2;
const cv::Size kSize(120, 100);
// Where the outline of something near meets the mask's border, the band's cut takes a triangle of 12 px with it.
constexpr int kCornerPx = 12 * 13 / 2;
const cv::Rect kObject(40, 20, 40, 60);

cv::Mat1f wallWith(const cv::Rect& object, float wall_m = 3.0F, float object_m = 1.0F) {
  cv::Mat1f depth(kSize, wall_m);
  depth(object).setTo(object_m);
  return depth;
}

cv::Mat1b labelled(const cv::Rect& box, std::uint8_t label = kPerson) {
  cv::Mat1b labels(kSize, std::uint8_t{0});
  labels(box).setTo(label);
  return labels;
}

cv::Rect grown(const cv::Rect& box, int by_px) {
  return {box.x - by_px, box.y - by_px, box.width + 2 * by_px, box.height + 2 * by_px};
}

RefinementConfig withStride(int stride_px) {
  RefinementConfig config;
  config.stride_px = stride_px;
  return config;
}

/// Over every pixel unless the test says otherwise: most scenes here are small, and exact to the pixel.
cv::Mat1b refine(const cv::Mat1b& labels, const cv::Mat1f& depth_m, const RefinementConfig& config = withStride(1)) {
  return DepthRefiner(config).refine({labels}, officeLabels(), frameOf(depth_m));
}

int differing(const cv::Mat1b& a, const cv::Mat1b& b) { return cv::countNonZero(a != b); }

RefinementConfig asPublished() {
  RefinementConfig config = withStride(1);
  config.average = "mean";
  config.min_region_share = 1.0;
  config.band_px = 0;
  return config;
}

TEST(MaskMoments, GiveTheCentroid) {
  MaskMoments moments;
  for (const cv::Point& p : {cv::Point(0, 0), cv::Point(4, 0), cv::Point(4, 3), cv::Point(0, 3), cv::Point(7, 9)}) {
    moments.add(p);
  }
  EXPECT_DOUBLE_EQ(moments.centroid().x, 3.0);
  EXPECT_DOUBLE_EQ(moments.centroid().y, 3.0);
}

class NeighbourDistance : public testing::Test {
 protected:
  /// 3x3 points 1 cm apart at 1 m; only the middle one is sampled.
  NeighbourDistance() : mask_(3, 3, 0), points_m_(3, 3) {
    for (int v = 0; v < 3; ++v) {
      for (int u = 0; u < 3; ++u) points_m_(v, u) = {0.01F * u, 0.01F * v, 1.0F};
    }
  }
  double measure(int samples = 1, bool median = false) {
    Rng rng(1);
    return neighbourDistance(mask_, 0, pixels_.data(), pixels_.size(), points_m_, samples, median, rng);
  }
  cv::Mat1i mask_;
  cv::Mat3f points_m_;
  std::vector<int> pixels_{4};
};

TEST_F(NeighbourDistance, LeavesTheLargestAndSmallestOut) {
  // Four neighbours at 1 cm, four at sqrt(2) cm: three of each are left.
  EXPECT_NEAR(measure(), (3 * 0.01 + 3 * 0.01414214) / 6, 1e-7);
  points_m_(1, 2)[2] = 3.0F;  // one of the near four steps back two metres: it is the largest now
  EXPECT_NEAR(measure(), (2 * 0.01 + 4 * 0.01414214) / 6, 1e-7);
}

TEST_F(NeighbourDistance, CountsOnlyNeighboursOfTheMaskWithDepth) {
  mask_.row(0).setTo(1);
  points_m_(2, 0)[2] = points_m_(2, 1)[2] = points_m_(2, 2)[2] = 0.0F;
  EXPECT_EQ(measure(), 0.0);  // two neighbours are too few
  points_m_(2, 1)[2] = 1.0F;
  EXPECT_NEAR(measure(), 0.01, 1e-7);
}

TEST_F(NeighbourDistance, AveragesOverTheSamplesByMeanOrMedian) {
  // Three samples of a plane, one of them at a step: the mean follows it, the median does not.
  mask_ = cv::Mat1i(3, 30, 0);
  points_m_ = cv::Mat3f(3, 30);
  for (int v = 0; v < 3; ++v) {
    for (int u = 0; u < 30; ++u) points_m_(v, u) = {0.01F * u, 0.01F * v, u < 28 ? 1.0F : 2.0F};
  }
  pixels_ = {30 + 5, 30 + 15, 30 + 27};
  EXPECT_NEAR(measure(301, true), 0.0120711, 1e-6);
  EXPECT_GT(measure(301, false), 0.05);
}

TEST(RefineOnDepth, CutsAMaskThatIsTooLargeBackToTheObject) {
  EXPECT_EQ(differing(refine(labelled(grown(kObject, 8)), wallWith(kObject)), labelled(kObject)), 0);
  EXPECT_EQ(differing(refine(labelled(grown(kObject, 3)), wallWith(kObject), asPublished()), labelled(kObject)), 0);
}

TEST(RefineOnDepth, KeepsNothingBehindAnEdgeOnAGrid) {
  const cv::Rect object(41, 21, 39, 59);  // begins and ends within blocks of the grid
  for (const int stride : {2, 3}) {
    const cv::Mat1b refined = refine(labelled(grown(object, 8)), wallWith(object), withStride(stride));
    EXPECT_EQ(cv::countNonZero(refined & ~(labelled(object) * 255)), 0) << "stride " << stride;
    // A block whose middle is not the object's goes with the background: a pixel at two of the four sides.
    EXPECT_LE(differing(refined, labelled(object)), object.width + object.height) << "stride " << stride;
  }
}

TEST(RefineOnDepth, CoversImagesThatAGridDoesNotDivide) {
  const cv::Size size(121, 99);
  const cv::Mat1b all(size, kPerson);
  EXPECT_EQ(differing(refine(all, cv::Mat1f(size, 2.0F), withStride(2)), all), 0);
  EXPECT_EQ(differing(refine(all, cv::Mat1f(size, 0.0F), withStride(4)), all), 0);
}

TEST(RefineOnDepth, NeverGrowsBeyondTheMask) {
  const cv::Rect half(kObject.x, kObject.y, kObject.width / 2, kObject.height);
  EXPECT_EQ(differing(refine(labelled(half), wallWith(kObject)), labelled(half)), 0);
}

TEST(RefineOnDepth, FollowsASlantedSurface) {
  cv::Mat1f depth = wallWith(kObject);
  for (int v = kObject.y; v < kObject.br().y; ++v) depth.row(v).colRange(40, 80).setTo(1.0F + 0.01F * (v - kObject.y));
  EXPECT_EQ(differing(refine(labelled(grown(kObject, 8)), depth), labelled(kObject)), 0);
}

TEST(RefineOnDepth, SeedsInsideTheMaskWhereTheCentroidIsNot) {
  cv::Mat1b ring = labelled(kObject);
  ring(grown(kObject, -12)).setTo(0);  // centroid in the middle of the hole, 3 m away
  cv::Mat1f depth(kSize, 3.0F);
  depth.setTo(1.0F, ring);
  EXPECT_EQ(differing(refine(ring, depth, asPublished()), ring), 0);
}

TEST(RefineOnDepth, SeedsWhereThereIsDepthAndKeepsTheHole) {
  cv::Mat1f depth = wallWith(kObject);
  depth(cv::Rect(55, 45, 10, 10)).setTo(0.0F);  // the centroid lies in it
  EXPECT_EQ(differing(refine(labelled(grown(kObject, 8)), depth, asPublished()), labelled(kObject)), 0);
}

TEST(RefineOnDepth, DropsTheShadowBesideTheObject) {
  cv::Mat1f depth = wallWith(kObject);
  depth(cv::Rect(kObject.br().x, kObject.y, 6, kObject.height)).setTo(0.0F);
  EXPECT_EQ(differing(refine(labelled(grown(kObject, 8)), depth), labelled(kObject)), 0);
}

TEST(RefineOnDepth, KeepsAnArmBeforeTheBody) {
  const cv::Rect arm(40, 40, 40, 16);
  cv::Mat1f depth = wallWith(kObject);
  depth(arm).setTo(0.7F);
  const cv::Mat1b mask = labelled(kObject);
  EXPECT_LE(differing(refine(mask, depth), mask), 4 * kCornerPx);
  EXPECT_EQ(differing(refine(mask, depth, asPublished()), labelled(arm)), 0);  // its only seed falls on the arm
}

TEST(RefineOnDepth, TakesTheLargestRegionWhereTheSeedFallsOnSomethingSmall) {
  cv::Mat1f depth = wallWith(kObject);
  const cv::Rect cup(57, 47, 6, 6);
  depth(cup).setTo(0.4F);  // before the body, where the centroid is
  cv::Mat1b expected = labelled(kObject);
  expected(cup).setTo(0);
  EXPECT_EQ(differing(refine(labelled(kObject), depth), expected), 0);
}

TEST(RefineOnDepth, KeepsTwoOverlappingPeopleButNotTheWallBehindAChair) {
  const cv::Rect left(20, 20, 40, 60), right(60, 20, 30, 60);
  cv::Mat1f depth(kSize, 4.0F);
  depth(left).setTo(1.0F);
  depth(right).setTo(2.5F);
  EXPECT_LE(differing(refine(labelled(left | right), depth), labelled(left | right)), 2 * kCornerPx);
  EXPECT_EQ(differing(refine(labelled(left | right, kChair), depth), labelled(left, kChair)), 0);
}

TEST(RefineOnDepth, RefinesEveryMaskByItself) {
  const cv::Rect person(10, 20, 30, 60), chair(70, 40, 30, 40);
  cv::Mat1f depth(kSize, 3.0F);
  depth(person).setTo(1.0F);
  depth(chair).setTo(2.0F);
  cv::Mat1b labels = labelled(grown(person, 5)), expected = labelled(person);
  labels(grown(chair, 5)).setTo(kChair);
  expected(chair).setTo(kChair);
  EXPECT_EQ(differing(refine(labels, depth), expected), 0);
}

/// A post that stands on a floor; both meet in the picture's lower part, and the floor meets the wall behind.
TEST(RefineOnDepth, CutsTheBandThatGrowthReachesOverTheFloor) {
  cv::Mat1f depth(kSize, 5.0F);
  for (int v = 30; v < kSize.height; ++v) depth.row(v).setTo(5.0F - 0.05F * static_cast<float>(v - 30));
  const cv::Rect post(50, 10, 20, 60);
  depth(post).setTo(depth(69, 0));  // as far as the floor where it stands
  const cv::Mat1b mask = labelled(grown(post, 8)), truth = labelled(post);
  RefinementConfig with = withStride(1);
  with.epsilon = 5.0;  // joins the rows of the floor
  RefinementConfig without = with;
  without.band_px = 0;
  const cv::Rect beside(post.x - 8, post.y, 8, 40);
  EXPECT_GT(cv::countNonZero(refine(mask, depth, without)(beside)), beside.area() / 2);
  EXPECT_EQ(cv::countNonZero(refine(mask, depth, with)(beside)), 0);
  EXPECT_EQ(cv::countNonZero(refine(mask, depth, with) & truth), post.area());
}

/// A floor that rises in the image, and an upright object that stands on it: no depth edge at its foot.
cv::Mat1f standingOnAFloor(const cv::Rect& object) {
  const auto floorInverseDepth = [](int v) { return 0.2F + 0.008F * static_cast<float>(v); };
  cv::Mat1f depth(kSize);
  for (int v = 0; v < kSize.height; ++v) depth.row(v).setTo(1.0F / floorInverseDepth(v));
  depth(object).setTo(1.0F / floorInverseDepth(object.br().y));
  return depth;
}

TEST(RefineOnDepth, CutsTheFloorBelowAFoot) {
  const cv::Mat1b refined = refine(labelled(grown(kObject, 8)), standingOnAFloor(kObject));
  const cv::Rect below(kObject.x, kObject.br().y, kObject.width,
                       8);  // from the mask's corners no way leads to the object
  EXPECT_EQ(cv::countNonZero(refined(below)), 0);
  EXPECT_GT(cv::countNonZero(refined(kObject)), 0.95 * kObject.area());
}

TEST(RefineOnDepth, KeepsAMaskThatIsTooSmallForItsSurface) {
  const cv::Mat1b labels = labelled(kObject);
  EXPECT_EQ(differing(refine(labels, cv::Mat1f(kSize, 2.0F)), labels), 0);
  const cv::Mat1b inside = labelled(grown(kObject, -15));
  EXPECT_EQ(differing(refine(inside, standingOnAFloor(kObject)), inside), 0);
}

TEST(DepthRefiner, CompletesPeople) {
  cv::Rect half = kObject;
  half.height /= 2;
  const RgbdFrame frame = frameOf(wallWith(kObject));
  const Segmentation doubtful{labelled(half), labelled(grown(kObject, 8)) * 255};
  EXPECT_EQ(differing(DepthRefiner(withStride(1)).refine(doubtful, officeLabels(), frame), labelled(kObject)), 0);
  RefinementConfig config = withStride(1);
  config.weak_share = 0.6;  // more than the half that is certain
  EXPECT_EQ(differing(DepthRefiner(config).refine(doubtful, officeLabels(), frame), labelled(half)), 0);
}

TEST(DepthRefiner, ForgetsOneFrameBeforeTheNext) {
  DepthRefiner refiner({});
  const RgbdFrame first = frameOf(wallWith(kObject)), second = frameOf(wallWith({5, 5, 30, 30}));
  const cv::Mat1b labels = labelled(grown({5, 5, 30, 30}, 4));
  const cv::Mat1b alone = refiner.refine({labels}, officeLabels(), second);
  refiner.refine({labelled(grown(kObject, 8))}, officeLabels(), first);
  EXPECT_EQ(differing(refiner.refine({labels}, officeLabels(), second), alone), 0);
  EXPECT_THROW(DepthRefiner(RefinementConfig{true, -1.0}), ConfigError);
}

TEST(RefineOnDepth, LeavesAMaskWithoutDepthAsItIs) {
  const cv::Mat1b mask = labelled(kObject);
  EXPECT_EQ(differing(refine(mask, cv::Mat1f::zeros(kSize)), mask), 0);
}

TEST(RefineOnDepth, DropsSpecks) {
  EXPECT_EQ(cv::countNonZero(refine(labelled({10, 10, 5, 5}), wallWith(kObject))), 0);
}

TEST(RefineOnDepth, CanBeSwitchedOff) {
  RefinementConfig off;
  off.enabled = false;
  const cv::Mat1b mask = labelled(grown(kObject, 8));
  EXPECT_EQ(differing(refine(mask, wallWith(kObject), off), mask), 0);
}

/// A round body 2 m away before a wall, with the noise and the depth quantum of a structured-light camera.
TEST(RefineOnDepth, RemovesMostOfTheBleedUnderRealisticNoise) {
  const cv::Size size(640, 480);
  cv::Mat1f depth(size, 3.2F);
  cv::Mat1b body(size, std::uint8_t{0});
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      const double x = (u - 320) / 70.0, y = (v - 260) / 180.0, r = x * x + y * y;
      if (r >= 1.0) continue;
      body(v, u) = kPerson;
      depth(v, u) = static_cast<float>(2.0 - 0.2 * std::sqrt(1.0 - r));
    }
  }
  Rng rng(7);
  for (float& z : depth) {
    const double noisy = z + rng.normal() * (0.0012 + 0.0019 * (z - 0.4) * (z - 0.4)), quantum = 2.85e-3 * z * z;
    z = static_cast<float>(std::round(noisy / quantum) * quantum);
  }
  cv::Mat1b mask;
  cv::dilate(body, mask, cv::getStructuringElement(cv::MORPH_ELLIPSE, {17, 17}));
  const cv::Mat1b refined = refine(mask, depth, {});
  const double off_before = static_cast<double>(cv::countNonZero(mask & ~(body * 255))) / cv::countNonZero(mask);
  const double off_after = static_cast<double>(cv::countNonZero(refined & ~(body * 255))) / cv::countNonZero(refined);
  EXPECT_GT(off_before, 0.1);
  EXPECT_LT(off_after, 0.2 * off_before);
  EXPECT_GT(cv::countNonZero(refined & body), 0.99 * cv::countNonZero(body));
  EXPECT_EQ(differing(refine(mask, depth, {}), refined), 0);  // the same seed gives the same samples
}

}  // namespace
}  // namespace semantic_vslam
