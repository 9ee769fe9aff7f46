// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "eval/fault_injection.h"

#include <gtest/gtest.h>

#include <cmath>

#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

constexpr double kFps = 30.0;

/// White images with depth 1 m.
class WhiteSource final : public FrameSource {
 public:
  explicit WhiteSource(std::size_t frames) : frames_(frames) {}

  std::optional<RgbdFrame> next() override {
    if (next_ >= frames_) return std::nullopt;
    const std::uint64_t index = next_++;
    return makeRgbdFrame(index, Stamp::fromSeconds(1.0 + static_cast<double>(index) / kFps),
                         cv::Mat3b(8, 8, cv::Vec3b(255, 255, 255)), cv::Mat1f(8, 8, 1.0F), 1.0, camera_);
  }
  void skip(std::size_t count) override { next_ += count; }
  std::size_t size() const override { return frames_; }
  std::size_t skippedBroken() const override { return 0; }
  std::shared_ptr<const CameraModel> camera() const override { return camera_; }
  const std::vector<TimedPose>& groundTruth() const override { return truth_; }
  cv::Mat1b groundTruthMask() const override { return cv::Mat1b(8, 8, std::uint8_t{255}); }

 private:
  std::size_t frames_, next_ = 0;
  std::shared_ptr<const CameraModel> camera_ = std::make_shared<CameraModel>(CameraIntrinsics{8, 8, 8, 8, 4, 4, {}});
  std::vector<TimedPose> truth_;
};

TEST(DrawCuts, KeepTheirLengthsAndDistances) {
  const CutPlan plan;
  std::size_t black = 0, all = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto cuts = drawCuts(790, kFps, plan, seed);
    ASSERT_EQ(cuts.size(), 5U);
    double free_since_s = plan.lead_s - plan.least_between_s;
    for (const Cut& cut : cuts) {
      const double begin_s = static_cast<double>(cut.begin) / kFps, end_s = static_cast<double>(cut.end) / kFps;
      EXPECT_GE(begin_s, free_since_s + plan.least_between_s - 0.04);
      EXPECT_GE(end_s - begin_s, plan.least_s - 0.04);
      EXPECT_LE(end_s - begin_s, plan.most_s + 0.04);
      free_since_s = end_s;
      black += cut.kind == Cut::Kind::kBlack ? 1 : 0;
      ++all;
    }
    EXPECT_LE(free_since_s, 790 / kFps - plan.least_between_s + 0.04);
  }
  EXPECT_GT(black, all / 4);
  EXPECT_LT(black, 3 * all / 4);
  EXPECT_THROW(drawCuts(300, kFps, plan, 1), Error);
}

TEST(DrawCuts, DependOnTheSeedAlone) {
  const auto a = drawCuts(790, kFps, {}, 7), b = drawCuts(790, kFps, {}, 7), c = drawCuts(790, kFps, {}, 8);
  EXPECT_EQ(a[2].begin, b[2].begin);
  EXPECT_NE(a[2].begin, c[2].begin);
}

TEST(CutSource, BlackensOrLeavesOutJustItsFrames) {
  WhiteSource white(12);
  CutSource source(white, {{2, 4, Cut::Kind::kBlack}, {6, 9, Cut::Kind::kSkipped}});
  std::vector<std::uint64_t> indices;
  while (const auto frame = source.next()) {
    indices.push_back(frame->index);
    const bool black = frame->index == 2 || frame->index == 3;
    EXPECT_EQ(frame->gray(4, 4), black ? 0 : 255) << frame->index;
    EXPECT_EQ(frame->depth_m(4, 4), black ? 0.0F : 1.0F) << frame->index;
    EXPECT_EQ(source.groundTruthMask().empty(), black) << frame->index;
  }
  EXPECT_EQ(indices, (std::vector<std::uint64_t>{0, 1, 2, 3, 4, 5, 9, 10, 11}));
}

/// Ten seconds on a curve, and the same in another frame, told OK but for a cut from frame 100 to 130.
struct Course {
  std::vector<TimedPose> truth;
  std::vector<ToldPose> told;

  Course() {
    const SE3 T_map_world = se3Exp((Vector6d() << 1, 2, 3, 0.3, -0.2, 0.5).finished());
    for (std::uint64_t i = 0; i < 300; ++i) {
      const double t = static_cast<double>(i) / kFps;
      SE3 pose = SE3::Identity();
      pose.translation() = Eigen::Vector3d(std::cos(t), std::sin(t), 0.2 * t);
      truth.push_back({Stamp::fromSeconds(1.0 + t), pose});
      told.push_back(
          {i, truth.back().stamp, i >= 100 && i < 130 ? TrackingState::kLost : TrackingState::kOk, T_map_world * pose});
    }
  }
};

const std::vector<Cut> kOneCut = {{100, 130, Cut::Kind::kBlack}};

TEST(ScoreRecovery, CountsFramesFromTheCutsEndToTheFirstPose) {
  Course course;
  for (int i = 130; i < 134; ++i) course.told[i].state = TrackingState::kLost;
  const auto recovery = scoreRecovery(kOneCut, course.told, course.truth).at(0);
  EXPECT_EQ(recovery.frames_needed, 5);
  EXPECT_LT(recovery.worst_error_m, 1e-9);
}

TEST(ScoreRecovery, SeesAWrongPlaceAtItsFullDistance) {
  Course course;
  for (int i = 130; i < 150; ++i) course.told[i].T_world_camera.translation().x() += 0.3;
  EXPECT_NEAR(scoreRecovery(kOneCut, course.told, course.truth).at(0).worst_error_m, 0.3, 1e-9);
}

TEST(ScoreRecovery, TellsWhenThereIsNoPoseAnyMore) {
  Course course;
  for (std::size_t i = 130; i < course.told.size(); ++i) course.told[i].state = TrackingState::kLost;
  EXPECT_EQ(scoreRecovery(kOneCut, course.told, course.truth).at(0).frames_needed, -1);
}

TEST(ScoreRecovery, APoseToldInTheDarkIsJudgedToo) {
  Course course;
  course.told[120].state = TrackingState::kOk;
  course.told[120].T_world_camera.translation().z() -= 0.2;
  EXPECT_GT(scoreRecovery(kOneCut, course.told, course.truth).at(0).worst_error_m, 0.19);
}

}  // namespace
}  // namespace semantic_vslam
