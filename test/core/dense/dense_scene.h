// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

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

/// background, person, chair
inline LabelSet threeLabels() {
  LabelSet set;
  set.classes.push_back({"person", Mobility::kPerson, {0, 0, 255}});
  set.classes.push_back({"chair", Mobility::kMovable, {0, 255, 0}});
  return set;
}

}  // namespace semantic_vslam
