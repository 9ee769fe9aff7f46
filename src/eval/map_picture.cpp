// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "eval/map_picture.h"

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "eval/cloud_view.h"

namespace semantic_vslam {
namespace {

const cv::Vec3b kRed(40, 40, 230), kGreen(150, 215, 150), kBlue(190, 105, 20), kPassable(255, 255, 255),
    kStanding(190, 190, 190);
constexpr double kPxPerM = 100.0;

}  // namespace

cv::Mat3b drawBesideTruth(const std::vector<LabelledPoint>& map, const std::vector<LabelledPoint>& wrong,
                          const cv::Mat3b& right_view, const SE3& T_world_camera, const CameraModel& camera,
                          double point_size_m) {
  std::vector<LabelledPoint> marked = wrong;  // first: of two at one depth the first is drawn
  for (LabelledPoint& point : marked) point.bgr = kRed;
  marked.insert(marked.end(), map.begin(), map.end());
  const cv::Mat3b view =
      renderCloud(marked, T_world_camera, camera, point_size_m, [](const LabelledPoint& p) { return p.bgr; });
  cv::Mat3b both;
  cv::hconcat(view, right_view, both);
  return both;
}

cv::Mat3b drawGrid(const OccupancyGrid& grid, double low_m, double high_m, const RoomTruth& truth) {
  const int side_px = std::max(2, static_cast<int>(std::lround(grid.resolution_m * kPxPerM)));
  cv::Mat3b picture(std::max(1, grid.height) * side_px, std::max(1, grid.width) * side_px, kPassable);
  const double px_m = grid.resolution_m / side_px;
  for (int row = 0; row < picture.rows; ++row) {
    for (int col = 0; col < picture.cols; ++col) {
      const int from_low = picture.rows - 1 - row;  // y up
      const double x_m = grid.origin_x_m + (col + 0.5) * px_m, y_m = grid.origin_y_m + (from_low + 0.5) * px_m;
      const bool stands = truth.obstacleOver(x_m, y_m, low_m, high_m) || !truth.obstacleOver(x_m, y_m, -0.05, 0.0);
      cv::Vec3b& pixel = picture(row, col);
      if (stands) pixel = kStanding;
      if (grid.cells.empty()) continue;
      const std::int8_t cell = grid.at(col / side_px, from_low / side_px);
      if (cell == OccupancyGrid::kOccupied) pixel = stands ? kBlue : cv::Vec3b(kBlue * 0.6 + kPassable * 0.4);
      if (cell == OccupancyGrid::kFree) pixel = stands ? kRed : kGreen;
    }
  }
  return picture;
}

cv::Mat3b drawObjects(const std::vector<MapObject>& objects, const SeenRoom& room, const LabelSet& labels) {
  const std::vector<SeenRoom::Thing> things = room.things(1);
  Eigen::AlignedBox2d area;
  for (const auto& thing : things) {
    for (const auto& p : thing.surface) area.extend(Eigen::Vector2d(p.head<2>()));
  }
  for (const MapObject& object : objects) area.extend(Eigen::Vector2d(object.centroid_m.head<2>()));
  if (area.isEmpty()) return cv::Mat3b(64, 64, kPassable);
  constexpr double kMarginM = 0.5, kScale = 1.6 * kPxPerM;
  const Eigen::Vector2d size = (area.sizes().array() + 2.0 * kMarginM) * kScale;
  cv::Mat3b picture(static_cast<int>(size.y()), static_cast<int>(size.x()), kPassable);
  const auto at = [&](double x_m, double y_m) {
    return cv::Point(cvRound((x_m - area.min().x() + kMarginM) * kScale),
                     picture.rows - 1 - cvRound((y_m - area.min().y() + kMarginM) * kScale));
  };
  const auto colour = [&](std::uint8_t label) {
    return label < labels.classes.size() ? labels.classes[label].color_bgr : cv::Vec3b(0, 0, 0);
  };
  for (const auto& thing : things) {
    const cv::Vec3b light = colour(thing.label) * 0.35 + kPassable * 0.65;
    for (const auto& p : thing.surface) cv::circle(picture, at(p.x(), p.y()), 2, light, cv::FILLED);
  }
  for (const auto& thing : things) {
    cv::circle(picture, at(thing.centroid_m.x(), thing.centroid_m.y()), 4, colour(thing.label), cv::FILLED);
  }
  for (const MapObject& object : objects) {
    const cv::Scalar bgr = colour(object.label);
    cv::rectangle(picture, at(object.box_m.min().x(), object.box_m.min().y()),
                  at(object.box_m.max().x(), object.box_m.max().y()), bgr, 2);
    cv::drawMarker(picture, at(object.centroid_m.x(), object.centroid_m.y()), bgr, cv::MARKER_CROSS, 14, 2);
  }
  return picture;
}

}  // namespace semantic_vslam
