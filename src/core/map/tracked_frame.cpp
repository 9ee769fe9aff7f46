// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/map/tracked_frame.h"

#include <cassert>
#include <utility>

namespace semantic_vslam {

TrackedFrame::TrackedFrame(const RgbdFrame& frame, FrameFeatures extracted)
    : index(frame.index),
      stamp(frame.stamp),
      camera(frame.camera),
      features(std::make_shared<const FrameFeatures>(std::move(extracted))),
      grid(*features, frame.camera->width(), frame.camera->height()),
      landmarks(features->size()) {}

Eigen::Vector3d TrackedFrame::pointInCamera(int i) const {
  assert(feature(i).depth_m > 0.0F);
  return camera->unprojectUndistorted(feature(i).undistorted_px.cast<double>(), feature(i).depth_m);
}

}  // namespace semantic_vslam
