// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <memory>

#include "core/common/rng.h"
#include "core/dense/keyframe_cloud.h"

/// Hand-made frames for the tests of dense/.
namespace semantic_vslam {

/// 64x48 px, no distortion, focal length 50 px: the ray of pixel (32, 24) is the optical axis.
inline std::shared_ptr<const CameraModel> smallCamera() {
  CameraIntrinsics k;
  k.width = 64;
  k.height = 48;
  k.fx = k.fy = 50.0;
  k.cx = 32.0;
  k.cy = 24.0;
  return std::make_shared<const CameraModel>(k);
}

/// A wall that fills the image at one depth, in one colour.
inline RgbdFrame wallFrame(float depth_m, const cv::Vec3b& bgr = {10, 20, 30}) {
  const auto camera = smallCamera();
  const cv::Size size(camera->width(), camera->height());
  return makeRgbdFrame(0, Stamp{1000}, cv::Mat3b(size, bgr), cv::Mat1f(size, depth_m), 1.0, camera);
}

/// A wall of many colours with boxes before it and holes in it, all of them anywhere.
inline RgbdFrame randomFrame(Rng& rng) {
  const auto below = [&](int count) { return static_cast<int>(rng.below(static_cast<std::size_t>(count))); };
  RgbdFrame frame = wallFrame(1.5F + 0.1F * static_cast<float>(below(20)));
  for (int i = 0; i < 4; ++i) {
    const cv::Rect box(below(50), below(36), 4 + below(10), 4 + below(8));
    frame.depth_m(box) = below(4) == 0 ? 0.0F : 0.8F + 0.1F * static_cast<float>(below(10));
    frame.bgr(box) = cv::Vec3b::all(static_cast<std::uint8_t>(below(256)));
  }
  return frame;
}

/// Somewhere within two metres, turned by up to a right angle.
inline SE3 randomPose(Rng& rng) {
  const auto unit = [&] { return static_cast<double>(rng.below(2001)) / 1000.0 - 1.0; };
  SE3 T = SE3::Identity();
  T.linear() = (Eigen::AngleAxisd(1.5 * unit(), Eigen::Vector3d::UnitY()) *
                Eigen::AngleAxisd(0.3 * unit(), Eigen::Vector3d::UnitX()))
                   .toRotationMatrix();
  T.translation() = Eigen::Vector3d(2.0 * unit(), 0.5 * unit(), 2.0 * unit());
  return T;
}

/// background, person, chair
inline LabelSet threeLabels() {
  LabelSet set;
  set.classes.push_back({"person", Mobility::kPerson, {0, 0, 255}});
  set.classes.push_back({"chair", Mobility::kMovable, {0, 255, 0}});
  return set;
}

}  // namespace semantic_vslam
