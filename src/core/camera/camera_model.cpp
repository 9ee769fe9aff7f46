// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "semantic_vslam/core/camera/camera_model.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <set>
#include <vector>

#include "core/camera/bilinear.h"
#include "core/common/input_file.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

// The table of rays, 8 bytes a pixel, is to have half a gigabyte at most.
constexpr int kMostSidePx = 8192;

/// From fish eyes to telescopes, looking anywhere near the image; written so that NaN is not.
bool plausible(double focal_px, double centre_px, int side_px) {
  return focal_px >= 0.01 * side_px && focal_px <= 1000.0 * side_px && std::abs(centre_px) <= 100.0 * side_px;
}

cv::Matx33d cameraMatrix(const CameraIntrinsics& k) { return {k.fx, 0, k.cx, 0, k.fy, k.cy, 0, 0, 1}; }

void undistortToRays(const CameraIntrinsics& k, const std::vector<cv::Point2d>& raw, std::vector<cv::Point2d>& rays) {
  // The plumb_bob model has no closed inverse; 20 fixed-point steps reach 1e-9 px for consumer lenses.
  const cv::TermCriteria criteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 20, 1e-9);
  cv::undistortPoints(raw, rays, cameraMatrix(k), k.distortion, cv::noArray(), cv::noArray(), criteria);
}

cv::Mat2f makeRayTable(const CameraIntrinsics& k) {
  std::vector<cv::Point2d> raw, rays;
  raw.reserve(static_cast<std::size_t>(k.width) * k.height);
  for (int v = 0; v < k.height; ++v) {
    for (int u = 0; u < k.width; ++u) raw.emplace_back(u, v);
  }
  undistortToRays(k, raw, rays);
  cv::Mat2f table(k.height, k.width);
  std::transform(rays.begin(), rays.end(), table.begin(), [](const cv::Point2d& ray) {
    return cv::Vec2f(static_cast<float>(ray.x), static_cast<float>(ray.y));
  });
  return table;
}

}  // namespace

CameraModel::CameraModel(const CameraIntrinsics& intrinsics) : intrinsics_(intrinsics) {
  const auto& k = intrinsics_;
  if (std::min(k.width, k.height) <= 0 || std::max(k.width, k.height) > kMostSidePx) {
    throw ConfigError("camera size is " + std::to_string(k.width) + "x" + std::to_string(k.height) +
                      ", each side must be in [1, " + std::to_string(kMostSidePx) + "] px");
  }
  if (!plausible(k.fx, k.cx, k.width) || !plausible(k.fy, k.cy, k.height)) {
    throw ConfigError("camera focal lengths or principal point cannot be (fx " + std::to_string(k.fx) + ", fy " +
                      std::to_string(k.fy) + ", cx " + std::to_string(k.cx) + ", cy " + std::to_string(k.cy) + " at " +
                      std::to_string(k.width) + "x" + std::to_string(k.height) + "); is the camera calibrated?");
  }
  for (const double coefficient : k.distortion) {
    if (!std::isfinite(coefficient)) throw ConfigError("camera distortion has a value that is not finite");
    distorted_ = distorted_ || coefficient != 0.0;
  }
  rays_ = makeRayTable(k);
}

Eigen::Vector2d CameraModel::projectUndistorted(const Eigen::Vector3d& p) const {
  return {fx() * p.x() / p.z() + cx(), fy() * p.y() / p.z() + cy()};
}

Eigen::Vector2d CameraModel::projectRaw(const Eigen::Vector3d& p) const {
  if (!distorted_) return projectUndistorted(p);
  double x = p.x() / p.z(), y = p.y() / p.z();
  distortPlumbBob(intrinsics_.distortion, x, y);
  return {fx() * x + cx(), fy() * y + cy()};
}

Eigen::Vector3d CameraModel::unprojectUndistorted(const Eigen::Vector2d& px, double depth_m) const {
  return {(px.x() - cx()) / fx() * depth_m, (px.y() - cy()) / fy() * depth_m, depth_m};
}

Eigen::Vector2d CameraModel::undistort(const Eigen::Vector2d& raw_px) const {
  if (!distorted_) return raw_px;
  // Bilinear look-up in the ray table: exact to 1e-3 px, and a hundred times cheaper than the iteration per feature.
  const double u = std::clamp(raw_px.x(), 0.0, width() - 1.001), v = std::clamp(raw_px.y(), 0.0, height() - 1.001);
  const int u0 = static_cast<int>(u), v0 = static_cast<int>(v);
  const cv::Vec2f ray = blendFour(rays_, u0, v0, static_cast<float>(u - u0), static_cast<float>(v - v0));
  return {fx() * ray[0] + cx(), fy() * ray[1] + cy()};
}

/// Files of other programs, which people have at hand, hold the same numbers.
static void refuseForeignForm(const YAML::Node& root, const std::string& path) {
  const char* form = root["camera_matrix"] ? "ROS's camera_calibration (camera_matrix: fx 0 cx, 0 fy cy; image_width)"
                     : root["Camera.fx"]   ? "ORB-SLAM (Camera.fx, Camera.k1)"
                     : root["cam0"]        ? "Kalibr (intrinsics: fx fy cx cy; resolution)"
                     : root["Camera1.fx"]  ? "ORB-SLAM3 (Camera1.fx, Camera1.k1)"
                                           : nullptr;
  if (form == nullptr) return;
  throw ConfigError("camera file '" + path + "' has the form of " + form +
                    "; write its numbers as width, height, fx, fy, cx, cy and distortion [k1, k2, p1, p2, k3], as in "
                    "cfg/cameras");
}

CameraIntrinsics loadCameraFile(const std::string& path) {
  static const std::set<std::string> known = {"width", "height", "fx", "fy", "cx", "cy", "distortion"};
  CameraIntrinsics k;
  try {
    const YAML::Node root = readYamlFile("camera file", path);
    if (!root.IsMap()) throw FileError("camera file '" + path + "' must be a YAML map");
    refuseForeignForm(root, path);
    for (const auto& item : root) {
      const auto key = item.first.as<std::string>();
      if (known.count(key) == 0) throw ConfigError("camera file '" + path + "': unknown key '" + key + "'");
    }
    const auto required = [&](const char* key) {
      if (!root[key]) throw ConfigError("camera file '" + path + "': key '" + key + "' is missing");
      return root[key];
    };
    k.width = required("width").as<int>();
    k.height = required("height").as<int>();
    k.fx = required("fx").as<double>();
    k.fy = required("fy").as<double>();
    k.cx = required("cx").as<double>();
    k.cy = required("cy").as<double>();
    if (root["distortion"]) {
      const auto values = root["distortion"].as<std::vector<double>>();
      if (values.size() != 4 && values.size() != k.distortion.size()) {
        throw ConfigError("camera file '" + path + "': distortion needs 4 or 5 values (k1 k2 p1 p2 and k3), has " +
                          std::to_string(values.size()));
      }
      std::copy(values.begin(), values.end(), k.distortion.begin());
    }
  } catch (const YAML::Exception& error) {
    throw FileError("camera file '" + path + "' is no valid camera description: " + error.what());
  }
  return k;
}

}  // namespace semantic_vslam
