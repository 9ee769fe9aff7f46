// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "core/common/rng.h"
#include "core/map/map.h"

namespace semantic_vslam {

/// A world of random points with random descriptors, and what cameras see of it: features with pixel and depth noise
/// and some flipped descriptor bits. Ground truth for everything behind the tracker, without images.
class SyntheticWorld {
 public:
  struct Point {
    Eigen::Vector3d position;
    cv::Mat1b descriptor;
    double size_m = 0.0;  ///< decides the octave at which it is seen: size_m * fx / depth = 31 px * 1.2^octave
  };
  struct Noise {
    double pixel_sigma = 0.5;      ///< times the scale of the octave
    double disparity_sigma = 0.3;  ///< px, virtual baseline 0.08 m
    int flipped_bits = 12;
  };
  struct View {
    std::shared_ptr<FrameFeatures> features;
    std::vector<int> point_of;  ///< per feature, index into points()
  };

  explicit SyntheticWorld(std::uint64_t seed) : rng_(seed), camera_(std::make_shared<CameraModel>(intrinsics())) {}

  static CameraIntrinsics intrinsics() { return {640, 480, 517.3, 516.5, 318.6, 255.3, {}}; }
  const std::shared_ptr<const CameraModel>& camera() const { return camera_; }
  const std::vector<Point>& points() const { return points_; }
  Rng& rng() { return rng_; }

  void addPoint(const Eigen::Vector3d& position) {
    Point point{position, cv::Mat1b(1, 32), 0.06 * std::pow(1.2, rng_.uniform(0.0, 5.0))};
    for (auto& byte : point.descriptor) byte = static_cast<std::uint8_t>(rng_.below(256));
    points_.push_back(point);
  }

  /// Points on the inside of a box, `count` in all.
  void addRoom(const Eigen::Vector3d& centre, const Eigen::Vector3d& size, int count) {
    for (int i = 0; i < count; ++i) {
      Eigen::Vector3d p(rng_.uniform(-0.5, 0.5), rng_.uniform(-0.5, 0.5), rng_.uniform(-0.5, 0.5));
      const int axis = static_cast<int>(rng_.below(3));
      p[axis] = rng_.below(2) == 0 ? -0.5 : 0.5;
      addPoint(centre + p.cwiseProduct(size));
    }
  }

  /// Adds every point so far once more, moved and with the same descriptor: a room that looks just the same.
  void addCopy(const Eigen::Vector3d& offset) {
    const std::size_t count = points_.size();
    for (std::size_t i = 0; i < count; ++i) {
      Point copy = points_[i];
      copy.position += offset;
      points_.push_back(copy);
    }
  }

  /// What a camera sees. @param max_range_m no feature past it  @param max_features the first ones that are in view
  View observe(const SE3& T_camera_world, const Noise& noise, double max_range_m = 8.0, int max_features = 1000) {
    View view;
    view.features = std::make_shared<FrameFeatures>();
    std::vector<cv::Mat1b> rows;
    for (std::size_t i = 0; i < points_.size() && static_cast<int>(view.point_of.size()) < max_features; ++i) {
      const Eigen::Vector3d p = T_camera_world * points_[i].position;
      if (p.z() < 0.3 || p.norm() > max_range_m) continue;
      const Eigen::Vector2d px = camera_->projectUndistorted(p);
      if (!camera_->contains(px, 5.0)) continue;
      const double level = std::log(points_[i].size_m * camera_->fx() / (31.0 * p.norm())) / std::log(kPyramidScale);
      const int octave = static_cast<int>(std::lround(level)) + 4;
      if (octave < 0 || octave >= kPyramidLevels) continue;
      view.features->features.push_back(makeFeature(px, p.z(), octave, noise));
      rows.push_back(flipped(points_[i].descriptor, noise.flipped_bits));
      view.point_of.push_back(static_cast<int>(i));
    }
    view.features->descriptors.create(static_cast<int>(rows.size()), 32);
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i].copyTo(view.features->descriptors.row(static_cast<int>(i)));
    return view;
  }

 private:
  Feature makeFeature(const Eigen::Vector2d& px, double depth_m, int octave, const Noise& noise) {
    const double sigma_px = noise.pixel_sigma * pyramidScale(octave);
    const double bf = camera_->fx() * 0.08;
    Feature feature;
    feature.undistorted_px = (px + sigma_px * Eigen::Vector2d(rng_.normal(), rng_.normal())).cast<float>();
    feature.raw_px = feature.undistorted_px;
    feature.depth_m = static_cast<float>(bf / std::max(1.0, bf / depth_m + noise.disparity_sigma * rng_.normal()));
    feature.octave = octave;
    return feature;
  }

  cv::Mat1b flipped(const cv::Mat1b& descriptor, int bits) {
    cv::Mat1b out = descriptor.clone();
    for (int i = 0; i < bits; ++i)
      out(0, static_cast<int>(rng_.below(32))) ^= static_cast<std::uint8_t>(1U << rng_.below(8));
    return out;
  }

  Rng rng_;
  std::shared_ptr<const CameraModel> camera_;
  std::vector<Point> points_;
};

/// A map as the tracker would have built it, with the world's points behind its landmarks.
struct SyntheticMap {
  Map map;
  std::vector<SE3> true_T_camera_world;             ///< per keyframe, in the order of their ids
  std::unordered_map<LandmarkId, int> point_of;     ///< index into the world's points
  std::unordered_map<int, LandmarkId> landmark_of;  ///< the newest landmark of a point
};

/// Adds one keyframe. Features of points whose landmark was last seen at most `memory` keyframes ago are matched to it;
/// the others become new landmarks, placed by the keyframe's estimated pose.
inline KeyframeId addKeyframe(SyntheticWorld& world, SyntheticMap& out, const SE3& true_pose, const SE3& estimated_pose,
                              const SyntheticWorld::Noise& noise, std::uint64_t memory = 1000000) {
  const SyntheticWorld::View view = world.observe(true_pose, noise);
  Keyframe keyframe;
  keyframe.stamp = Stamp::fromSeconds(static_cast<double>(out.true_T_camera_world.size()));
  keyframe.T_camera_world = estimated_pose;
  keyframe.camera = world.camera();
  keyframe.features = view.features;
  keyframe.landmarks.assign(view.features->size(), LandmarkId());
  const std::uint64_t now = out.true_T_camera_world.size();
  for (std::size_t i = 0; i < view.point_of.size(); ++i) {
    const auto known = out.landmark_of.find(view.point_of[i]);
    if (known == out.landmark_of.end()) continue;
    const Landmark* landmark = out.map.landmark(known->second);
    if (landmark == nullptr || landmark->observations.rbegin()->first.value() + memory < now) continue;
    keyframe.landmarks[i] = known->second;
  }
  const KeyframeId id = out.map.addKeyframe(keyframe);
  out.true_T_camera_world.push_back(true_pose);
  for (std::size_t i = 0; i < view.point_of.size(); ++i) {
    if (out.map.keyframe(id)->landmarks[i].valid()) continue;
    const Feature& feature = view.features->features[i];
    const Eigen::Vector3d in_camera =
        world.camera()->unprojectUndistorted(feature.undistorted_px.cast<double>(), feature.depth_m);
    const LandmarkId made = out.map.addLandmark(estimated_pose.inverse() * in_camera, id, static_cast<int>(i));
    out.point_of[made] = view.point_of[i];
    out.landmark_of[view.point_of[i]] = made;
  }
  return id;
}

}  // namespace semantic_vslam
