// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/mapping/landmark_triangulation.h"

#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "core/camera/observation_model.h"
#include "core/features/matcher.h"
#include "core/geometry/rays.h"

namespace semantic_vslam {
namespace {

// Chi-square bound of one degree of freedom, 95 %: the distance from the epipolar line.
constexpr double kChi2Line = 3.841;
// Two views of one point may differ by this many pyramid levels before distance is taken into account.
constexpr int kMaxOctaveGap = 2;

/// Static features without a landmark.
std::vector<int> openFeatures(const Keyframe& keyframe) {
  std::vector<int> open;
  const auto& features = keyframe.features->features;
  for (int i = 0; i < static_cast<int>(features.size()); ++i) {
    if (!keyframe.landmarks[i].valid() && features[i].surelyStatic()) open.push_back(i);
  }
  return open;
}

Eigen::Vector3d rayInCamera(const Keyframe& keyframe, int feature) {
  return keyframe.camera->unprojectUndistorted(keyframe.features->features[feature].undistorted_px.cast<double>(), 1.0);
}

Ray rayInWorld(const Keyframe& keyframe, int feature) {
  const SE3 T_world_camera = keyframe.T_camera_world.inverse();
  return {T_world_camera.translation(), (T_world_camera.linear() * rayInCamera(keyframe, feature)).normalized()};
}

/// The epipolar line of a feature of `a` in the image of `b`, as (n_x, n_y, c) with n_x u + n_y v + c the distance, px.
Eigen::Vector3d epipolarLine(const Eigen::Matrix3d& E_b_a, const Keyframe& a, int feature, const CameraModel& b) {
  const Eigen::Vector3d line = E_b_a * rayInCamera(a, feature);  // in rays of b
  Eigen::Vector3d in_px(line.x() / b.fx(), line.y() / b.fy(), 0.0);
  in_px.z() = line.z() - in_px.x() * b.cx() - in_px.y() * b.cy();
  return in_px / in_px.head<2>().norm();
}

/// For each open feature of `a` the one of `b` on its epipolar line that looks like it, if one alone does.
std::vector<FeatureMatch> matchAlongEpipolarLines(const Keyframe& a, const std::vector<int>& open_a, const Keyframe& b,
                                                  const std::vector<int>& open_b, double ratio) {
  const Eigen::Matrix3d E_b_a = essentialMatrix(b.T_camera_world * a.T_camera_world.inverse());
  std::vector<FeatureMatch> best_of_b(b.features->size(), FeatureMatch{-1, -1, std::numeric_limits<int>::max()});
  for (const int i : open_a) {
    const Eigen::Vector3d line = epipolarLine(E_b_a, a, i, *b.camera);
    FeatureMatch best{i, -1, kMaxDistanceStrict + 1};
    int second = 256;
    for (const int j : open_b) {
      const Feature& feature = b.features->features[j];
      const double distance_px =
          line.x() * feature.undistorted_px.x() + line.y() * feature.undistorted_px.y() + line.z();
      const double sigma_px = pyramidScale(feature.octave);
      if (distance_px * distance_px > kChi2Line * sigma_px * sigma_px) continue;
      if (std::abs(feature.octave - a.features->features[i].octave) > kMaxOctaveGap) continue;
      const int distance = descriptorDistance(a.features->descriptors.ptr(i), b.features->descriptors.ptr(j));
      if (distance < best.distance) {
        second = best.feature >= 0 ? best.distance : second;
        best.feature = j;
        best.distance = distance;
      } else {
        second = std::min(second, distance);
      }
    }
    if (best.feature < 0 || best.distance > ratio * second) continue;
    if (best.distance < best_of_b[best.feature].distance) best_of_b[best.feature] = best;
  }
  std::vector<FeatureMatch> matches;
  for (const FeatureMatch& match : best_of_b) {
    if (match.feature >= 0) matches.push_back(match);
  }
  return matches;
}

bool fitsFeature(const Keyframe& keyframe, int feature_index, const Eigen::Vector3d& point_world,
                 const SensorConfig& sensor) {
  const VirtualStereo camera(keyframe.camera->intrinsics(), sensor.virtual_baseline_m);
  const Feature& feature = keyframe.features->features[feature_index];
  const PixelMeasurement m = makeMeasurement(feature.undistorted_px.cast<double>(), feature.depth_m,
                                             pyramidScale(feature.octave), 1.0, camera, sensor);
  return fits(camera, m, keyframe.T_camera_world * point_world);
}

/// A point seen from twice as far looks half as large: the pyramid levels must agree with that.
bool sizesAgree(const Keyframe& a, int i, const Keyframe& b, int j, const Eigen::Vector3d& point_world) {
  const double distance_ratio = (a.T_camera_world * point_world).norm() / (b.T_camera_world * point_world).norm();
  const double size_ratio = pyramidScale(b.features->features[j].octave) / pyramidScale(a.features->features[i].octave);
  constexpr double kTolerance = 1.5 * kPyramidScale;  // Mur-Artal and Tardos 2015
  return distance_ratio < size_ratio * kTolerance && distance_ratio * kTolerance > size_ratio;
}

std::optional<Eigen::Vector3d> pointOf(const Keyframe& a, int i, const Keyframe& b, int j, const SensorConfig& sensor,
                                       double min_parallax_rad) {
  const Ray ray_a = rayInWorld(a, i), ray_b = rayInWorld(b, j);
  if (parallax(ray_a, ray_b) < min_parallax_rad) return std::nullopt;
  const auto point_world = intersectRays(ray_a, ray_b);
  if (!point_world || !fitsFeature(a, i, *point_world, sensor) || !fitsFeature(b, j, *point_world, sensor))
    return std::nullopt;
  if (!sizesAgree(a, i, b, j, *point_world)) return std::nullopt;
  return point_world;
}

}  // namespace

int triangulateNewLandmarks(Map& map, KeyframeId id, const SensorConfig& sensor, const TriangulationConfig& config) {
  if (map.keyframe(id) == nullptr) return 0;
  const double min_parallax_rad = config.min_parallax_deg * M_PI / 180.0;
  int made = 0, asked = 0;
  for (const auto& [neighbour, shared] : map.covisible(id, 1)) {
    if (asked++ >= config.neighbours) break;
    const Keyframe &a = *map.keyframe(id), &b = *map.keyframe(neighbour);
    for (const FeatureMatch& match :
         matchAlongEpipolarLines(a, openFeatures(a), b, openFeatures(b), config.match_ratio)) {
      const auto point_world = pointOf(a, match.query, b, match.feature, sensor, min_parallax_rad);
      if (!point_world) continue;
      const LandmarkId landmark = map.addLandmark(*point_world, id, match.query);
      map.addObservation(neighbour, match.feature, landmark);
      map.refreshLandmark(landmark);
      ++made;
    }
  }
  return made;
}

}  // namespace semantic_vslam
