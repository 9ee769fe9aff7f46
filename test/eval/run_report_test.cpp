// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "eval/run_report.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

namespace semantic_vslam {
namespace {

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

RunReport smallReport() {
  RunReport report;
  report.sequence = "a/b";
  report.frames = 250;
  report.posed = 249;
  report.keyframes = 31;
  report.frames_in_state["OK"] = 249;
  report.motion = {{0, "none", 0, 0.0}, {1, "rigid_flow", 480, 0.25}, {2, "rigid_flow", 431, 0.05}};
  report.stages.push_back({"motion", 250, {10.0, 12.0, 20.0}, {9.0, 11.0, 18.0}});
  return report;
}

TEST(RunReport, WithoutTruthErrorsAndMaskAreNull) {
  const std::string json = toJson(smallReport());
  for (const char* part : {"\"frames\": 250", "\"posed\": 249", "\"posed_share\": 0.996", "\"ate_rmse_m\": null",
                           "\"mask\": null", "\"mean_dynamic_share\": 0.1", "\"OK\": 249", "\"median\": 9"}) {
    EXPECT_TRUE(contains(json, part)) << part << " in\n" << json;
  }
  EXPECT_FALSE(contains(toText(smallReport()), "ATE"));
}

TEST(RunReport, TellsOfEveryFrameWhatTheMotionStageSaid) {
  const std::string json = toJson(smallReport());
  for (const char* part :
       {"\"rigid_flow\": 2", "\"frame\": [0, 1, 2]", "\"inliers\": [0, 480, 431]",
        "\"model\": [\"none\", \"rigid_flow\", \"rigid_flow\"]", "\"dynamic_share\": [0, 0.25, 0.05]"}) {
    EXPECT_TRUE(contains(json, part)) << part << " in\n" << json;
  }
}

TEST(RunReport, WithTruthItHoldsTheErrors) {
  RunReport report = smallReport();
  report.absolute.emplace();
  report.absolute->translation_m.rmse = 0.0125;
  report.relative.emplace();
  report.relative->rotation_deg.rmse = 0.5;
  report.mask.add((cv::Mat1b(1, 4) << 255, 255, 0, 0), (cv::Mat1b(1, 4) << 255, 0, 0, 0));
  const std::string json = toJson(report), text = toText(report);
  EXPECT_TRUE(contains(json, "\"ate_rmse_m\": 0.0125"));
  EXPECT_TRUE(contains(json, "\"precision\": 0.5"));
  EXPECT_TRUE(contains(text, "249 of 250 frames posed (99.6 %)"));
  EXPECT_TRUE(contains(text, "ATE RMSE 0.0125 m"));
  EXPECT_TRUE(contains(text, "mask IoU 0.500, precision 0.500, recall 1.000"));
  EXPECT_TRUE(contains(text, "motion"));
}

TEST(RunReport, ARunOfNoFramesHasShareZero) { EXPECT_TRUE(contains(toJson(RunReport{}), "\"posed_share\": 0")); }

TEST(PeakMemory, GrowsWithWhatIsTouched) {
  const double before_mb = peakMemoryMb();
  ASSERT_GT(before_mb, 1.0);
  std::vector<char> block(64 << 20, 1);
  EXPECT_GT(peakMemoryMb(), before_mb + 50.0 * (block[12345] != 0));
}

TEST(RunReport, TimeSinceTheProcessStartedGoesOn) {
  const double before_s = secondsSinceProcessStart();
  EXPECT_GE(before_s, 0.0);
  EXPECT_LT(before_s, 600.0) << "this program has not run for longer";
  std::this_thread::sleep_for(std::chrono::milliseconds(30));
  EXPECT_GE(secondsSinceProcessStart(), before_s + 0.02);
}

}  // namespace
}  // namespace semantic_vslam
