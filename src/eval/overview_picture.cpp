// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "eval/overview_picture.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/dense/up_direction.h"
#include "core/motion/mask_picture.h"
#include "eval/cloud_view.h"
#include "eval/plot_panel.h"
#include "eval/trajectory_plot.h"
#include "semantic_vslam/core/common/stage_timing.h"

namespace semantic_vslam {
namespace {

const cv::Scalar kInk(60, 60, 60), kPathColor(190, 105, 20), kTruthColor(60, 60, 60);
// What hangs higher over the camera than this (ceiling, lamps) would hide the room from above.
constexpr double kCutAboveCameraM = 0.5;

/// Into the frame that is drawn, z up: that of the ground truth, if there is one; else up is where floor or desk say,
/// and the first camera looks up the page.
SE3 viewFromWorld(const OverviewContent& content) {
  if (content.absolute) return content.absolute->truth_from_estimate.T_target_source;
  const Eigen::Vector3d up = estimateUpDirection(content.cloud, -Eigen::Vector3d::UnitY());
  const Eigen::Vector3d right = Eigen::Vector3d::UnitZ().cross(up).normalized();
  SE3 T_view_world = SE3::Identity();
  T_view_world.linear().row(0) = right.transpose();
  T_view_world.linear().row(1) = up.cross(right).transpose();
  T_view_world.linear().row(2) = up.transpose();
  return T_view_world;
}

std::vector<Eigen::Vector3d> positionsOf(const std::vector<TimedPose>& poses, const SE3& T) {
  std::vector<Eigen::Vector3d> positions;
  for (const auto& pose : poses) positions.push_back(T * pose.T_world_camera.translation());
  return positions;
}

/// Cloud points in the drawn frame, the lowest first.
std::vector<std::pair<Eigen::Vector3d, cv::Vec3b>> pointsFromAbove(const OverviewContent& content, const SE3& T,
                                                                   double highest_camera_m) {
  std::vector<std::pair<Eigen::Vector3d, cv::Vec3b>> points;
  for (const LabelledPoint& point : content.cloud) {
    const Eigen::Vector3d p = T * point.position();
    if (p.z() < highest_camera_m + kCutAboveCameraM) points.emplace_back(p, point.bgr);
  }
  std::stable_sort(points.begin(), points.end(),
                   [](const auto& a, const auto& b) { return a.first.z() < b.first.z(); });
  return points;
}

/// Range that holds all of the path and nearly all of the cloud: single far points would make the rest tiny.
AxisRange rangeOf(const std::vector<Eigen::Vector3d>& path, std::vector<double> cloud, int axis) {
  std::vector<double> values;
  for (const auto& position : path) values.push_back(position[axis]);
  if (!cloud.empty()) {
    values.push_back(quantile(cloud, 0.005));
    values.push_back(quantile(cloud, 0.995));
  }
  return AxisRange::around(values, 0.05);
}

std::vector<cv::Point2d> flat(const std::vector<Eigen::Vector3d>& positions) {
  std::vector<cv::Point2d> points;
  for (const auto& position : positions) points.emplace_back(position.x(), position.y());
  return points;
}

void drawFromAbove(PlotCanvas& canvas, cv::Rect area_px, const OverviewContent& content) {
  const SE3 T = viewFromWorld(content);
  const auto path = positionsOf(content.trajectory, T);
  double highest_m = -1e9;
  for (const auto& position : path) highest_m = std::max(highest_m, position.z());
  const auto cloud = pointsFromAbove(content, T, path.empty() ? 1e9 : highest_m);
  std::vector<double> x_m, y_m;
  for (const auto& [p, bgr] : cloud) {
    x_m.push_back(p.x());
    y_m.push_back(p.y());
  }
  PlotPanel panel(canvas, area_px, {"Map from above", "x (m)", "y (m)"}, rangeOf(path, x_m, 0), rangeOf(path, y_m, 1),
                  true);
  const double dot_px = content.cloud_resolution_m * panel.pixelsPerUnitX();
  for (const auto& [p, bgr] : cloud) panel.dot({p.x(), p.y()}, dot_px, bgr);
  if (!content.truth.empty() && !content.trajectory.empty()) {
    std::vector<TimedPose> seen;
    for (const auto& pose : content.truth) {
      if (content.trajectory.front().stamp <= pose.stamp && pose.stamp <= content.trajectory.back().stamp) {
        seen.push_back(pose);
      }
    }
    panel.line(flat(positionsOf(seen, SE3::Identity())), kTruthColor, 2.0);
    panel.legend("ground truth", kTruthColor);
  }
  if (path.empty()) return;
  panel.line(flat(path), kPathColor, 2.0);
  panel.disc({path.front().x(), path.front().y()}, 5.0, kPathColor);
  panel.legend("camera (disc: start)", kPathColor);
}

void drawSample(PlotCanvas& canvas, const OverviewContent& content, int top_px) {
  constexpr int kWidth = 520, kHeight = 390, kGap = 20;
  const auto label_color = [&](const LabelledPoint& point) {
    return point.label < content.labels.size() ? content.labels.classes[point.label].color_bgr : cv::Vec3b();
  };
  const auto own_color = [](const LabelledPoint& point) { return point.bgr; };
  const auto view = [&](const auto& color) {
    return renderCloud(content.cloud, content.sample_T_world_camera, *content.camera, content.cloud_resolution_m,
                       color);
  };
  const std::pair<const char*, cv::Mat3b> pictures[] = {
      {"An image; red: taken as moving", maskPicture(content.sample_bgr, content.sample_dynamic)},
      {"The map from the same pose", view(own_color)},
      {"The map by label", view(label_color)}};
  int left_px = 20;
  for (const auto& [name, picture] : pictures) {
    canvas.text(name, {left_px + 2.0, top_px + 14.0}, 11.0, kInk, true);
    const double scale = std::min(1.0 * kWidth / picture.cols, 1.0 * kHeight / picture.rows);
    const cv::Size size(std::max(1, cvRound(scale * picture.cols)), std::max(1, cvRound(scale * picture.rows)));
    canvas.image(picture, cv::Rect(cv::Point(left_px, top_px + 24), size));
    left_px += kWidth + kGap;
  }
}

/// The labels in the map, from the commonest on, in lines within an area; those that find no place in it are counted.
void drawLegendOfLabels(PlotCanvas& canvas, const OverviewContent& content, const cv::Rect2d& area_px) {
  std::vector<std::size_t> count(content.labels.size(), 0);
  for (const auto& point : content.cloud) {
    if (point.label < count.size()) ++count[point.label];
  }
  std::vector<std::size_t> seen;
  for (std::size_t label = 0; label < count.size(); ++label) {
    if (count[label] > 0) seen.push_back(label);
  }
  std::stable_sort(seen.begin(), seen.end(), [&](std::size_t a, std::size_t b) { return count[a] > count[b]; });
  constexpr double kLine = 18, kRoomForMore = 90;
  cv::Point2d at_px(area_px.x, area_px.y + 12);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const auto& entry = content.labels.classes[seen[i]];
    const double width_px = 40 + PlotCanvas::textWidth(entry.name, 10.0);
    const bool last_line = at_px.y + kLine > area_px.br().y;
    if (at_px.x + width_px > area_px.br().x - (last_line ? kRoomForMore : 0.0)) {
      if (last_line) {
        canvas.text("and " + std::to_string(seen.size() - i) + " more", at_px, 10.0, kInk);
        return;
      }
      at_px = {area_px.x, at_px.y + kLine};
    }
    canvas.fill(cv::Rect2d(at_px.x, at_px.y - 10, 12, 12), entry.color_bgr);
    canvas.text(entry.name, {at_px.x + 18, at_px.y}, 10.0, kInk);
    at_px.x += width_px;
  }
}

}  // namespace

cv::Mat3b drawOverview(const OverviewContent& content) {
  PlotCanvas canvas(cv::Size(1640, 1200));
  canvas.text(content.title, {30, 34}, 15.0, kInk, true);
  canvas.text(content.subtitle, {30, 60}, 11.0, kInk);
  const bool with_error = content.absolute && !content.absolute->matches.empty();
  drawFromAbove(canvas, cv::Rect(10, 75, with_error ? 900 : 1620, 640), content);
  if (with_error) drawErrorOverTime(canvas, cv::Rect(920, 75, 710, 640), *content.absolute);
  if (!content.sample_bgr.empty() && content.camera) {
    drawSample(canvas, content, 725);
    drawLegendOfLabels(canvas, content, {30, 1148, 1600, 48});
  }
  return canvas.picture();
}

}  // namespace semantic_vslam
