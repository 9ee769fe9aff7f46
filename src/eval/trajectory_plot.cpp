// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "eval/trajectory_plot.h"

#include <cstdio>

#include "eval/plot_panel.h"

namespace semantic_vslam {
namespace {

const cv::Scalar kTruthColor(60, 60, 60), kEstimateColor(190, 105, 20), kErrorColor(60, 60, 225);
constexpr double kMargin = 0.08;
// A break in the ground truth longer than this is left open instead of bridged by a straight line.
constexpr double kMaxTruthGapS = 0.5;

std::vector<TimedPose> within(const std::vector<TimedPose>& poses, Stamp first, Stamp last) {
  std::vector<TimedPose> part;
  for (const TimedPose& pose : poses) {
    if (first <= pose.stamp && pose.stamp <= last) part.push_back(pose);
  }
  return part;
}

cv::Point2d project(const Eigen::Vector3d& position_m, int vertical_axis) {
  return {position_m.x(), position_m[vertical_axis]};
}

void drawTruth(PlotPanel& panel, const std::vector<TimedPose>& truth, int vertical_axis) {
  std::vector<cv::Point2d> stretch;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (i > 0 && secondsBetween(truth[i - 1].stamp, truth[i].stamp) > kMaxTruthGapS) {
      panel.line(stretch, kTruthColor, 1.8);
      stretch.clear();
    }
    stretch.push_back(project(truth[i].T_world_camera.translation(), vertical_axis));
  }
  panel.line(stretch, kTruthColor, 1.8);
}

/// @param vertical_axis  what is drawn upwards: 1 = y, 2 = z
void drawPaths(PlotCanvas& canvas, cv::Rect area_px, const std::vector<TimedPose>& truth,
               const std::vector<MatchedPosition>& matches, int vertical_axis, const PanelText& text) {
  std::vector<double> x_m, y_m;
  const auto include = [&](const Eigen::Vector3d& position_m) {
    x_m.push_back(position_m.x());
    y_m.push_back(position_m[vertical_axis]);
  };
  for (const auto& pose : truth) include(pose.T_world_camera.translation());
  for (const auto& match : matches) include(match.estimate_world_m);
  PlotPanel panel(canvas, area_px, text, AxisRange::around(x_m, kMargin), AxisRange::around(y_m, kMargin), true);

  drawTruth(panel, truth, vertical_axis);
  std::vector<cv::Point2d> estimate;
  for (const auto& match : matches) {
    estimate.push_back(project(match.estimate_world_m, vertical_axis));
    panel.segment(estimate.back(), project(match.truth_world_m, vertical_axis), kErrorColor, 0.8);
  }
  panel.line(estimate, kEstimateColor, 1.5);
  panel.disc(estimate.front(), 5.0, kEstimateColor);
  panel.legend("ground truth", kTruthColor);
  panel.legend("estimate (disc: start)", kEstimateColor);
  panel.legend("error", kErrorColor);
}

}  // namespace

void drawErrorOverTime(PlotCanvas& canvas, cv::Rect area_px, const AbsoluteTrajectoryError& error) {
  const Stamp begin = error.matches.front().stamp, end = error.matches.back().stamp;
  const double to_cm = 100.0;
  const AxisRange time_s{0.0, std::max(secondsBetween(begin, end), 1e-3)};
  const AxisRange height_cm{0.0, std::max(1.15 * error.translation_m.max * to_cm, 1e-3)};
  PlotPanel panel(canvas, area_px,
                  {"Absolute position error after alignment", "time since the first pose (s)", "error (cm)"}, time_s,
                  height_cm, false);
  std::vector<cv::Point2d> curve;
  for (const auto& match : error.matches) {
    curve.emplace_back(secondsBetween(begin, match.stamp), match.error_m * to_cm);
  }
  panel.line(curve, kErrorColor, 1.3);
  const double rmse_cm = error.translation_m.rmse * to_cm;
  panel.segment({time_s.low, rmse_cm}, {time_s.high, rmse_cm}, kTruthColor, 1.2);
  char text[64];
  std::snprintf(text, sizeof text, "RMSE %.2f cm", rmse_cm);
  panel.legend("error", kErrorColor);
  panel.legend(text, kTruthColor);
}

cv::Mat3b drawTrajectoryComparison(const std::vector<TimedPose>& truth, const AbsoluteTrajectoryError& error,
                                   const std::string& title) {
  PlotCanvas canvas(cv::Size(1500, 1060));
  canvas.text(title, {40, 36}, 15.0, kTruthColor, true);
  const auto& matches = error.matches;
  const std::vector<TimedPose> seen = within(truth, matches.front().stamp, matches.back().stamp);
  drawPaths(canvas, cv::Rect(10, 60, 740, 640), seen, matches, 1, {"From above", "x (m)", "y (m)"});
  drawPaths(canvas, cv::Rect(750, 60, 740, 640), seen, matches, 2, {"From the side", "x (m)", "z (m)"});
  drawErrorOverTime(canvas, cv::Rect(10, 710, 1480, 340), error);
  return canvas.picture();
}

}  // namespace semantic_vslam
