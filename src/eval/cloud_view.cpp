// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "eval/cloud_view.h"

#include <algorithm>
#include <limits>

namespace semantic_vslam {
namespace {

constexpr double kNearestM = 0.1;  // points closer than this would cover the picture
const cv::Vec3b kNothing(235, 235, 235);

}  // namespace

cv::Mat3b renderCloud(const std::vector<LabelledPoint>& cloud, const SE3& T_world_camera, const CameraModel& camera,
                      double point_size_m, const std::function<cv::Vec3b(const LabelledPoint&)>& color) {
  const cv::Size size(camera.width(), camera.height());
  cv::Mat3b picture(size, kNothing);
  cv::Mat1f nearest_m(size, std::numeric_limits<float>::infinity());
  const SE3 T_camera_world = T_world_camera.inverse();
  for (const LabelledPoint& point : cloud) {
    const Eigen::Vector3d p = T_camera_world * point.position();
    if (p.z() < kNearestM) continue;
    // The plumb_bob polynomial turns back far outside the image: points there must not fold into it.
    const Eigen::Vector2d ideal_px = camera.projectUndistorted(p);
    if (!camera.contains(ideal_px, -0.25 * size.width)) continue;
    const Eigen::Vector2d px = camera.projectRaw(p);
    const int side = std::max(1, static_cast<int>(std::lround(camera.fx() * point_size_m / p.z())));
    const cv::Point corner(cvRound(px.x()) - side / 2, cvRound(px.y()) - side / 2);
    const cv::Rect square = cv::Rect(corner, cv::Size(side, side)) & cv::Rect({0, 0}, size);
    const auto depth_m = static_cast<float>(p.z());
    const cv::Vec3b bgr = color(point);
    for (int v = square.y; v < square.br().y; ++v) {
      for (int u = square.x; u < square.br().x; ++u) {
        if (depth_m >= nearest_m(v, u)) continue;
        nearest_m(v, u) = depth_m;
        picture(v, u) = bgr;
      }
    }
  }
  return picture;
}

}  // namespace semantic_vslam
