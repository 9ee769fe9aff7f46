// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <memory>
#include <vector>

#include "core/common/rng.h"
#include "core/features/frame_features.h"
#include "core/map/tracked_frame.h"
#include "semantic_vslam/core/camera/camera_model.h"
#include "semantic_vslam/core/geometry/se3.h"

namespace semantic_vslam {

/// Points with descriptors of their own in front of a wall, and the features that a camera would find of them: ground
/// truth for matching, tracking and the map, without images.
class PointScene {
 public:
  explicit PointScene(int points, std::uint64_t seed = 1) : rng_(seed) {
    for (int i = 0; i < points; ++i) {
      points_world.emplace_back(rng_.uniform(-1.6, 1.6), rng_.uniform(-1.2, 1.2), rng_.uniform(1.5, 3.0));
      cv::Mat1b descriptor(1, 32);
      for (auto& byte : descriptor) byte = static_cast<std::uint8_t>(rng_.below(256));
      descriptors.push_back(descriptor);
    }
  }

  /// @param noise_px  sigma of the feature positions  @param depth_noise_m  sigma of the depth at 1 m, grows with z^2
  /// @param visible   indices of the points that were found, in the order of the features
  FrameFeatures view(const SE3& T_camera_world, double noise_px, double depth_noise_m, std::vector<int>* visible) {
    FrameFeatures out;
    if (visible) visible->clear();
    for (std::size_t i = 0; i < points_world.size(); ++i) {
      const Eigen::Vector3d p = T_camera_world * points_world[i];
      if (p.z() < 0.3) continue;
      const Eigen::Vector2d px = camera->projectUndistorted(p);
      if (!camera->contains(px, 2.0)) continue;
      Feature feature;
      feature.undistorted_px = (px + noise_px * Eigen::Vector2d(rng_.normal(), rng_.normal())).cast<float>();
      feature.raw_px = feature.undistorted_px;
      feature.depth_m = static_cast<float>(p.z() + depth_noise_m * p.z() * p.z() * rng_.normal());
      feature.octave = 1;
      out.features.push_back(feature);
      out.descriptors.push_back(descriptors[i]);
      if (visible) visible->push_back(static_cast<int>(i));
    }
    return out;
  }

  TrackedFrame frame(std::uint64_t index, const SE3& T_camera_world, double noise_px = 0.0, double depth_noise_m = 0.0,
                     std::vector<int>* visible = nullptr) {
    RgbdFrame images;
    images.index = index;
    images.stamp = Stamp{static_cast<std::int64_t>(index) * 33'000'000};
    images.camera = camera;
    return TrackedFrame(images, view(T_camera_world, noise_px, depth_noise_m, visible));
  }

  std::shared_ptr<const CameraModel> camera = std::make_shared<CameraModel>(CameraIntrinsics());
  std::vector<Eigen::Vector3d> points_world;
  std::vector<cv::Mat1b> descriptors;

 private:
  Rng rng_;
};

/// Pose of a camera at `position_m` in the world, turned by `yaw_rad` about its y axis. @return T_camera_world
inline SE3 cameraAt(const Eigen::Vector3d& position_m, double yaw_rad = 0.0) {
  SE3 T_world_camera = SE3::Identity();
  T_world_camera.linear() = so3Exp({0.0, yaw_rad, 0.0});
  T_world_camera.translation() = position_m;
  return T_world_camera.inverse();
}

}  // namespace semantic_vslam
