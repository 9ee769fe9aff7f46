// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <opencv2/core.hpp>

#include "eval/scenario.h"
#include "eval/synthetic/scene.h"
#include "semantic_vslam/core/camera/camera_model.h"
#include "semantic_vslam/core/camera/rgbd_frame.h"
#include "semantic_vslam/core/common/label_set.h"
#include "semantic_vslam/core/geometry/se3.h"

namespace semantic_vslam {

/// A rendered frame with everything that is true about it. All images are height x width.
struct SyntheticFrame {
  RgbdFrame frame;         ///< as a Kinect would give it: noise, quantisation, holes
  cv::Mat1f true_depth_m;  ///< exact, unlimited; 0 = nothing there
  cv::Mat1b person_mask;   ///< 255 on people
  /// 255 on everything that moved by more than 2 mm in the world since the frame before (people, pushed and carried
  /// things); a person who stands still is not in it, apart from limbs that move.
  cv::Mat1b moving_mask;
  cv::Mat1b labels;    ///< indices into syntheticLabels()
  SE3 T_world_camera;  ///< exact; world z is up, the floor is z = 0
};

/// background, person, chair, monitor, keyboard, mouse, book, laptop, bottle, cup, table.
LabelSet syntheticLabels();

/// Renders a scenario. Deterministic: the same scenario, camera and time give the same bytes, in any order and from any
/// number of threads at once (render is const and shares nothing that changes).
class SyntheticRoom {
 public:
  /// Paints the textures and builds the furniture: about half a second a room.
  /// @throws ConfigError if the scenario has no room or no camera knot, or the intrinsics are not valid.
  SyntheticRoom(const Scenario& scenario, const CameraIntrinsics& intrinsics);
  ~SyntheticRoom();

  /// @param time_s  from the start of the scenario
  SyntheticFrame render(double time_s) const;
  /// Stamp of the frame rendered at a time: 1000 s later, since stamp 0 means "none" in ROS.
  static Stamp stampAt(double time_s);

  /// The solids that a true map of the whole recording holds: the room and what nobody carries when it ends.
  synthetic::Primitives standingAtTheEnd() const;

  const Scenario& scenario() const;
  /// Number of frames of the whole scenario at its frame rate.
  int frameCount() const;
  double frameTime(int index) const { return index / scenario().fps; }

 private:
  class Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace semantic_vslam
