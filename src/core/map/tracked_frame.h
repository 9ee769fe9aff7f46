// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/features/feature_grid.h"
#include "core/features/frame_features.h"
#include "semantic_vslam/core/camera/rgbd_frame.h"
#include "semantic_vslam/core/common/ids.h"
#include "semantic_vslam/core/geometry/se3.h"

namespace semantic_vslam {

/// A frame on its way through tracking: its features, and what they have been matched to so far.
struct TrackedFrame {
  std::uint64_t index = 0;
  Stamp stamp;
  std::shared_ptr<const CameraModel> camera;
  std::shared_ptr<const FrameFeatures> features;
  FeatureGrid grid;
  std::vector<LandmarkId> landmarks;  ///< per feature; invalid id = none
  SE3 T_camera_world = SE3::Identity();

  TrackedFrame() = default;
  TrackedFrame(const RgbdFrame& frame, FrameFeatures extracted);

  const Feature& feature(int i) const { return features->features[i]; }
  /// The point of feature i in this camera's frame, metres. Call only where the feature has depth.
  Eigen::Vector3d pointInCamera(int i) const;
};

}  // namespace semantic_vslam
