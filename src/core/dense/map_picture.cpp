// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/dense/map_picture.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "core/common/rng.h"
#include "core/io/image_file.h"
#include "semantic_vslam/core/common/config_fields.h"

namespace semantic_vslam {
namespace {

const cv::Vec3b kCanvas(34, 30, 28);
const cv::Scalar kText(235, 235, 235), kPath(0, 190, 255), kStart(80, 220, 80), kEnd(60, 60, 255), kFrame(80, 76, 72);
constexpr int kLegendHeightPx = 44;

Eigen::Vector3d position(const LabelledPoint& point) { return {point.xyz_m[0], point.xyz_m[1], point.xyz_m[2]}; }

/// @param share  0.5 = median  @return that quantile of the values; 0 of none.
double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

/// About `count` points, evenly out of all.
std::vector<Eigen::Vector3d> samplePositions(const std::vector<LabelledPoint>& cloud, std::size_t count) {
  std::vector<Eigen::Vector3d> sample;
  const std::size_t step = std::max<std::size_t>(1, cloud.size() / count);
  for (std::size_t i = 0; i < cloud.size(); i += step) sample.push_back(position(cloud[i]));
  return sample;
}

struct Plane {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  double offset_m = 0.0;
  bool holds(const Eigen::Vector3d& p) const {
    constexpr double kThicknessM = 0.02;  // depth noise at 2-3 m
    return std::abs(normal.dot(p) - offset_m) < kThicknessM;
  }
};

Plane fitPlane(const std::vector<Eigen::Vector3d>& points, const Plane& initial) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector3d> held;
  std::copy_if(points.begin(), points.end(), std::back_inserter(held), [&](const auto& p) { return initial.holds(p); });
  for (const auto& p : held) mean += p / static_cast<double>(held.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const auto& p : held) scatter += (p - mean) * (p - mean).transpose();
  Plane plane;
  plane.normal = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvectors().col(0);
  if (plane.normal.dot(initial.normal) < 0.0) plane.normal = -plane.normal;
  plane.offset_m = plane.normal.dot(mean);
  return plane;
}

/// How one view sees the world: perspective, or from so far that it is orthographic.
struct View {
  SE3 T_view_world = SE3::Identity();
  bool perspective = true;
  double scale = 1.0;  ///< focal length in px, or px per metre
  cv::Size size;

  /// @param uvz  column, row (px) and depth (m)  @param px_per_m  scale at the point
  /// @return false if the point is behind the viewer
  bool project(const Eigen::Vector3d& p_world, Eigen::Vector3d& uvz, double& px_per_m) const {
    const Eigen::Vector3d p = T_view_world * p_world;
    constexpr double kNearestM = 0.1;
    if (p.z() < kNearestM) return false;
    px_per_m = perspective ? scale / p.z() : scale;
    uvz = {p.x() * px_per_m + size.width / 2.0, p.y() * px_per_m + size.height / 2.0, p.z()};
    return true;
  }
};

SE3 lookAt(const Eigen::Vector3d& eye, const Eigen::Vector3d& forward, const Eigen::Vector3d& down_hint) {
  const Eigen::Vector3d z = forward.normalized();
  const Eigen::Vector3d x = down_hint.cross(z).normalized();
  SE3 T_world_view = SE3::Identity();
  T_world_view.linear().col(0) = x;
  T_world_view.linear().col(1) = z.cross(x);
  T_world_view.linear().col(2) = z;
  T_world_view.translation() = eye;
  return T_world_view.inverse();
}

/// What all views are chosen from.
struct Scene {
  std::vector<Eigen::Vector3d> sample;  ///< some points of the cloud
  Eigen::Vector3d centre = Eigen::Vector3d(0, 0, 2), up, eye = Eigen::Vector3d::Zero();
  Eigen::Vector3d forward = Eigen::Vector3d::UnitZ();  ///< mean direction in which the camera looked
};

Scene surveyScene(const std::vector<LabelledPoint>& cloud, const std::vector<SE3>& trajectory) {
  Scene scene;
  scene.sample = samplePositions(cloud, 20000);
  for (int axis = 0; axis < 3 && !scene.sample.empty(); ++axis) {
    std::vector<double> values;
    for (const auto& p : scene.sample) values.push_back(p[axis]);
    scene.centre[axis] = quantile(values, 0.5);
  }
  Eigen::Vector3d up_sum = Eigen::Vector3d::Zero(), forward_sum = Eigen::Vector3d::Zero();
  for (const SE3& T_world_camera : trajectory) {
    scene.eye += T_world_camera.translation() / static_cast<double>(trajectory.size());
    up_sum -= T_world_camera.linear().col(1);
    forward_sum += T_world_camera.linear().col(2);
  }
  if (up_sum.norm() < 1e-3) up_sum = -Eigen::Vector3d::UnitY();
  if (forward_sum.norm() > 0.1 * static_cast<double>(trajectory.size())) scene.forward = forward_sum.normalized();
  scene.up = estimateUpDirection(cloud, up_sum.normalized());
  return scene;
}

double shareInside(const View& view, const std::vector<Eigen::Vector3d>& points) {
  std::size_t inside = 0;
  for (const auto& p : points) {
    Eigen::Vector3d uvz;
    double px_per_m = 0.0;
    if (!view.project(p, uvz, px_per_m)) continue;
    if (uvz.x() >= 0 && uvz.y() >= 0 && uvz.x() < view.size.width && uvz.y() < view.size.height) ++inside;
  }
  return points.empty() ? 1.0 : static_cast<double>(inside) / static_cast<double>(points.size());
}

/// From behind and above the camera's mean place, as far back as it takes to see nearly all of the map.
View perspectiveView(const Scene& scene, const std::vector<SE3>& trajectory, const cv::Size& size) {
  View view;
  view.size = size;
  view.scale = 0.9 * size.width;  // 58 degrees across
  const double distance_m = std::max(0.5, (scene.centre - scene.eye).norm());
  const Eigen::Vector3d level = (scene.forward - scene.forward.dot(scene.up) * scene.up).normalized();
  std::vector<Eigen::Vector3d> path;
  for (const SE3& T_world_camera : trajectory) path.push_back(T_world_camera.translation());
  for (int step = 0; step < 30; ++step) {
    const double back_m = distance_m * (1.0 + 0.1 * step);
    const Eigen::Vector3d eye = scene.centre + back_m * (0.55 * scene.up - 0.85 * level);
    view.T_view_world = lookAt(eye, scene.centre - eye, -scene.up);
    if (shareInside(view, scene.sample) >= 0.95 && shareInside(view, path) >= 0.98) break;
  }
  return view;
}

/// From above, far enough up to be orthographic; the mean viewing direction points up in the picture.
View topView(const Scene& scene, const std::vector<SE3>& trajectory, const cv::Size& size) {
  View view;
  view.size = size;
  view.perspective = false;
  const Eigen::Vector3d level = scene.forward - scene.forward.dot(scene.up) * scene.up;
  const SE3 T_axes_world = lookAt(Eigen::Vector3d::Zero(), -scene.up, -level);
  std::array<std::vector<double>, 3> along;
  for (const auto& p : scene.sample) {
    for (int axis = 0; axis < 3; ++axis) along[axis].push_back((T_axes_world * p)[axis]);
  }
  Eigen::Vector3d low, high;
  for (int axis = 0; axis < 3; ++axis) {
    low[axis] = quantile(along[axis], 0.005);
    high[axis] = quantile(along[axis], 0.995);
  }
  for (const SE3& T_world_camera : trajectory) {
    const Eigen::Vector3d p = T_axes_world * T_world_camera.translation();
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const Eigen::Vector3d extent = (high - low).cwiseMax(0.1);
  view.scale = 0.92 * std::min(size.width / extent.x(), size.height / extent.y());
  Eigen::Vector3d eye = 0.5 * (low + high);
  eye.z() = low.z() - 1.0;  // z points down; a metre above the highest point
  view.T_view_world = T_axes_world;
  view.T_view_world.translation() = -eye;
  return view;
}

/// The nearest point at each pixel.
struct Splat {
  cv::Mat1f depth_m;
  cv::Mat1i point;  // -1 = none
};

Splat splat(const std::vector<LabelledPoint>& cloud, const View& view, double point_m) {
  Splat out{cv::Mat1f(view.size, std::numeric_limits<float>::max()), cv::Mat1i(view.size, -1)};
  const cv::Rect whole(cv::Point(0, 0), view.size);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    Eigen::Vector3d uvz;
    double px_per_m = 0.0;
    if (!view.project(position(cloud[i]), uvz, px_per_m)) continue;
    const int side = std::clamp(static_cast<int>(std::ceil(point_m * px_per_m)), 1, 25);
    const cv::Rect square(static_cast<int>(std::floor(uvz.x())) - side / 2,
                          static_cast<int>(std::floor(uvz.y())) - side / 2, side, side);
    const cv::Rect visible = square & whole;
    const auto z = static_cast<float>(uvz.z());
    for (int v = visible.y; v < visible.br().y; ++v) {
      for (int u = visible.x; u < visible.br().x; ++u) {
        if (z >= out.depth_m(v, u)) continue;
        out.depth_m(v, u) = z;
        out.point(v, u) = static_cast<int>(i);
      }
    }
  }
  return out;
}

/// Eye-dome lighting (Boucheny 2009): a pixel is darkened by how far it lies behind its neighbours, so that shapes show
/// without normals. @return factor 0..1 for each pixel.
cv::Mat1f eyeDomeShade(const cv::Mat1f& depth_m) {
  constexpr int kReachPx = 2;
  constexpr float kStrength = 6.0F, kNone = std::numeric_limits<float>::max();
  static const std::array<cv::Point, 4> kNeighbours = {{{kReachPx, 0}, {-kReachPx, 0}, {0, kReachPx}, {0, -kReachPx}}};
  cv::Mat1f shade(depth_m.size(), 1.0F);
  const cv::Rect whole(cv::Point(0, 0), depth_m.size());
  for (int v = 0; v < depth_m.rows; ++v) {
    for (int u = 0; u < depth_m.cols; ++u) {
      if (depth_m(v, u) == kNone) continue;
      float behind = 0.0F;
      for (const cv::Point& step : kNeighbours) {
        const cv::Point neighbour = cv::Point(u, v) + step;
        if (!whole.contains(neighbour) || depth_m(neighbour) == kNone) continue;
        behind += std::max(0.0F, std::log2(depth_m(v, u) / depth_m(neighbour)));
      }
      shade(v, u) = std::max(0.35F, std::exp(-kStrength * behind));
    }
  }
  return shade;
}

cv::Vec3b labelColour(std::uint8_t label, const LabelSet& labels) {
  return label < labels.size() ? labels.classes[label].color_bgr : cv::Vec3b(200, 0, 200);
}

/// Label colour with the light that the camera saw, so that things are still recognised.
cv::Vec3b litLabelColour(const LabelledPoint& point, const LabelSet& labels) {
  const double light = (0.114 * point.bgr[0] + 0.587 * point.bgr[1] + 0.299 * point.bgr[2]) / 255.0;
  return cv::Vec3b(cv::Vec3d(labelColour(point.label, labels)) * (0.5 + 1.0 * light));
}

template <class ColourOf>
cv::Mat3b paint(const Splat& splat, const cv::Mat1f& shade, const ColourOf& colour_of) {
  cv::Mat3b image(splat.point.size(), kCanvas);
  for (int v = 0; v < image.rows; ++v) {
    for (int u = 0; u < image.cols; ++u) {
      if (splat.point(v, u) >= 0) image(v, u) = cv::Vec3b(cv::Vec3d(colour_of(splat.point(v, u))) * shade(v, u));
    }
  }
  return image;
}

void drawTrajectory(cv::Mat3b& image, const View& view, const std::vector<SE3>& trajectory) {
  constexpr int kShift = 4;  // sixteenths of a pixel
  std::vector<cv::Point> path;
  for (const SE3& T_world_camera : trajectory) {
    Eigen::Vector3d uvz;
    double px_per_m = 0.0;
    if (!view.project(T_world_camera.translation(), uvz, px_per_m)) continue;
    path.emplace_back(cvRound(uvz.x() * (1 << kShift)), cvRound(uvz.y() * (1 << kShift)));
  }
  if (path.empty()) return;
  cv::polylines(image, path, false, cv::Scalar(0, 0, 0), 4, cv::LINE_AA, kShift);
  cv::polylines(image, path, false, kPath, 2, cv::LINE_AA, kShift);
  cv::circle(image, path.front(), 6 << kShift, kStart, cv::FILLED, cv::LINE_AA, kShift);
  cv::circle(image, path.back(), 6 << kShift, kEnd, cv::FILLED, cv::LINE_AA, kShift);
}

void drawText(cv::Mat3b& image, const std::string& text, const cv::Point& at, double size = 0.55) {
  cv::putText(image, text, at, cv::FONT_HERSHEY_SIMPLEX, size, cv::Scalar(0, 0, 0), 4, cv::LINE_AA);
  cv::putText(image, text, at, cv::FONT_HERSHEY_SIMPLEX, size, kText, 1, cv::LINE_AA);
}

/// A bar of 1, 2 or 5 times a power of ten metres, at most a quarter of the view wide.
void drawScaleBar(cv::Mat3b& image, double px_per_m) {
  const double widest_m = 0.25 * image.cols / px_per_m;
  const double power = std::pow(10.0, std::floor(std::log10(widest_m)));
  const double length_m = power * (widest_m >= 5 * power ? 5 : widest_m >= 2 * power ? 2 : 1);
  const cv::Point left(20, image.rows - 20), right(20 + cvRound(length_m * px_per_m), image.rows - 20);
  cv::line(image, left, right, cv::Scalar(0, 0, 0), 7);
  cv::line(image, left, right, kText, 3);
  char text[32];
  std::snprintf(text, sizeof(text), "%g m", length_m);
  drawText(image, text, left + cv::Point(0, -10));
}

/// Swatches of the labels that the cloud holds, most points first, and the meaning of the path.
void drawLegend(cv::Mat3b strip, const std::vector<LabelledPoint>& cloud, const LabelSet& labels) {
  std::vector<std::size_t> count(256, 0);
  for (const auto& point : cloud) ++count[point.label];
  std::vector<int> present;
  for (int label = 0; label < 256; ++label) {
    if (count[static_cast<std::size_t>(label)] > 0) present.push_back(label);
  }
  std::stable_sort(present.begin(), present.end(), [&](int a, int b) { return count[a] > count[b]; });
  int x = 16;
  const int y = strip.rows / 2;
  const auto entry = [&](const cv::Scalar& colour, const std::string& text) {
    cv::rectangle(strip, cv::Rect(x, y - 9, 18, 18), colour, cv::FILLED);
    drawText(strip, text, {x + 26, y + 6});
    x += 26 + cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, 0.55, 1, nullptr).width + 24;
  };
  entry(kStart, "start");
  entry(kEnd, "end");
  entry(kPath, "camera path");
  for (const int label : present) {
    const bool known = static_cast<std::size_t>(label) < labels.size();
    const cv::Vec3b colour = labelColour(static_cast<std::uint8_t>(label), labels);
    const std::string name = known ? labels.classes[label].name : "label " + std::to_string(label);
    char share[16];
    std::snprintf(share, sizeof(share), " %.1f%%", 100.0 * count[label] / static_cast<double>(cloud.size()));
    if (x > strip.cols - 160) break;  // the rest are the smallest
    entry(colour, name + share);
  }
}

/// One row of the picture: the same view in the colours of the camera and of the labels.
void drawRow(cv::Mat3b left, cv::Mat3b right, const std::string& title, const View& view,
             const std::vector<LabelledPoint>& cloud, const std::vector<SE3>& trajectory, const LabelSet& labels,
             double point_m) {
  const Splat points = splat(cloud, view, point_m);
  const cv::Mat1f shade = eyeDomeShade(points.depth_m);
  paint(points, shade, [&](int i) { return cloud[i].bgr; }).copyTo(left);
  paint(points, shade, [&](int i) { return litLabelColour(cloud[i], labels); }).copyTo(right);
  for (cv::Mat3b* image : {&left, &right}) {
    drawTrajectory(*image, view, trajectory);
    if (!view.perspective) drawScaleBar(*image, view.scale);
    cv::rectangle(*image, cv::Rect(cv::Point(0, 0), image->size()), kFrame, 1);
  }
  drawText(left, title + ", camera colours", {14, 26});
  drawText(right, title + ", labels", {14, 26});
}

/// Points of a ceiling would hide the room from above: what lies well over the camera's path is left out there.
std::vector<LabelledPoint> withoutCeiling(const std::vector<LabelledPoint>& cloud, const std::vector<SE3>& trajectory,
                                          const Eigen::Vector3d& up) {
  constexpr double kAbovePathM = 0.6;
  if (trajectory.empty()) return cloud;
  double highest_m = -std::numeric_limits<double>::max();
  for (const SE3& T : trajectory) highest_m = std::max(highest_m, up.dot(T.translation()));
  std::vector<LabelledPoint> kept;
  std::copy_if(cloud.begin(), cloud.end(), std::back_inserter(kept),
               [&](const LabelledPoint& point) { return up.dot(position(point)) < highest_m + kAbovePathM; });
  return kept;
}

}  // namespace

Eigen::Vector3d estimateUpDirection(const std::vector<LabelledPoint>& cloud, const Eigen::Vector3d& prior_up) {
  constexpr int kTrials = 400;
  const double least_cosine = std::cos(50.0 * CV_PI / 180.0);
  const std::vector<Eigen::Vector3d> points = samplePositions(cloud, 3000);
  if (points.size() < 3) return prior_up;
  Rng rng(1);
  Plane best;
  std::ptrdiff_t most = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Eigen::Vector3d &a = points[rng.below(points.size())], &b = points[rng.below(points.size())],
                          &c = points[rng.below(points.size())];
    Plane plane;
    plane.normal = (b - a).cross(c - a);
    if (plane.normal.norm() < 1e-6) continue;
    plane.normal.normalize();
    if (plane.normal.dot(prior_up) < 0.0) plane.normal = -plane.normal;
    if (plane.normal.dot(prior_up) < least_cosine) continue;
    plane.offset_m = plane.normal.dot(a);
    const auto held = std::count_if(points.begin(), points.end(), [&](const auto& p) { return plane.holds(p); });
    if (held <= most) continue;
    most = held;
    best = plane;
  }
  if (most < static_cast<std::ptrdiff_t>(points.size() / 20)) return prior_up;
  return fitPlane(points, best).normal;
}

cv::Mat3b drawMapPicture(const std::vector<LabelledPoint>& cloud, const std::vector<SE3>& trajectory,
                         const LabelSet& labels, const MapPictureConfig& config) {
  validateConfig(config);
  const cv::Size size(config.view_width_px, config.view_height_px);
  const Scene scene = surveyScene(cloud, trajectory);
  cv::Mat3b picture(2 * size.height + kLegendHeightPx, 2 * size.width, kCanvas);
  const auto cell = [&](int column, int row) {
    return picture(cv::Rect(cv::Point(column * size.width, row * size.height), size));
  };
  drawRow(cell(0, 0), cell(1, 0), "perspective", perspectiveView(scene, trajectory, size), cloud, trajectory, labels,
          config.point_m);
  drawRow(cell(0, 1), cell(1, 1), "from above", topView(scene, trajectory, size),
          withoutCeiling(cloud, trajectory, scene.up), trajectory, labels, config.point_m);
  drawLegend(picture.rowRange(2 * size.height, picture.rows), cloud, labels);
  return picture;
}

void saveMapPicture(const std::string& path, const std::vector<LabelledPoint>& cloud,
                    const std::vector<SE3>& trajectory, const LabelSet& labels, const MapPictureConfig& config) {
  writeImageFile(path, drawMapPicture(cloud, trajectory, labels, config));
}

}  // namespace semantic_vslam
