// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "semantic_vslam/core/dense/dense_config.h"
#include "semantic_vslam/core/motion/motion_config.h"
#include "semantic_vslam/core/pipeline/keyframe_inputs.h"
#include "semantic_vslam/core/pipeline/removal.h"
#include "semantic_vslam/core/pipeline/sparse_slam_config.h"
#include "semantic_vslam/core/pipeline/tracking_stage.h"
#include "semantic_vslam/core/segmentation/segmentation_config.h"

namespace semantic_vslam {

/// The stages' configs together: the keys of a configuration file and of `--set`.
struct SystemConfig {
  MotionConfig motion;
  SegmentationConfig segmentation;
  RemovalConfig removal;
  TrackingWaits waits;
  SparseSlamConfig slam;
  DenseConfig dense;
  KeyframeInputsConfig inputs;
  double label_delay_s = 0.0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.group("motion", motion);
    v.group("segmentation", segmentation);
    v.group("removal", removal);
    waits.visit(v);
    slam.visit(v);  // tracking, mapping and optimisation are top-level groups
    v.group("dense", dense);
    inputs.visit(v);
    v.field("label_delay_s", label_delay_s, 0.0, 60.0,
            "labels reach the motion stage at least this long after their image, s: to measure what late masks cost");
  }
};

}  // namespace semantic_vslam
