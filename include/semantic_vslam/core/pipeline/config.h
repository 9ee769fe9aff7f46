// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "semantic_vslam/core/common/label_set.h"
#include "semantic_vslam/core/dense/dense_config.h"
#include "semantic_vslam/core/features/features_config.h"
#include "semantic_vslam/core/loop/loop_config.h"
#include "semantic_vslam/core/mapping/mapping_config.h"
#include "semantic_vslam/core/motion/motion_config.h"
#include "semantic_vslam/core/optimization/optimization_config.h"
#include "semantic_vslam/core/segmentation/segmentation_config.h"
#include "semantic_vslam/core/tracking/tracking_config.h"

namespace semantic_vslam {

/// The configs of tracking, map upkeep, relocalisation and loop closing together.
struct SparseSlamConfig {
  TrackerConfig tracking;
  MapMaintenanceConfig sparse_map;
  TriangulationConfig triangulation;
  BaConfig bundle_adjustment;
  PlaceIndexConfig places;
  RelocalisationConfig relocalisation;
  bool close_loops = true;
  LoopDetectorConfig loop_detection;
  LoopCorrectorConfig loop_correction;

  template <class Visitor>
  void visit(Visitor& v) {
    v.group("sensor", tracking.frame.sensor);
    v.group("depth_noise", tracking.frame.sensor.depth_noise);
    v.group("tracking", tracking);
    v.group("sparse_map", sparse_map);
    v.group("triangulation", triangulation);
    v.group("bundle_adjustment", bundle_adjustment);
    v.group("places", places);
    v.group("relocalisation", relocalisation);
    v.flag("close_loops", close_loops,
           "false: places seen again are not looked for; drift stays, and new maps are not joined with old ones");
    v.group("loop_detection", loop_detection);
    v.group("loop_correction", loop_correction);
  }
};

/// How long a frame waits for what other stages make of it.
struct TrackingWaits {
  int mask_budget_ms = 60;
  double init_wait_s = 10.0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("mask_budget_ms", mask_budget_ms, 0, 1000,
            "ms a frame waits for its motion mask before it is tracked without; two frames at 30 Hz");
    v.field("init_wait_s", init_wait_s, 0.0, 60.0,
            "s the start waits for the first labels, so that no person enters the first map; 0: motion alone must do. "
            "Where "
            "no network is configured it does not wait");
  }
};

/// How long a keyframe waits for what belongs to it, and how long the dense map waits for a keyframe.
struct KeyframeInputsConfig {
  double labels_wait_s = 3.0;
  double mask_wait_s = 0.5;
  double look_period_s = 0.45;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("labels_wait_s", labels_wait_s, 0.0, 30.0,
            "s a keyframe waits for its labels while a network runs; without them it stays out of the map");
    v.field("mask_wait_s", mask_wait_s, 0.0, 30.0, "s a keyframe waits for its motion mask");
    v.field(
        "look_period_s", look_period_s, 0.05, 3600.0,
        "s without a keyframe after which the dense map looks at a frame between, one that has labels where a network "
        "runs; a little less than segmentation.longest_gap_s, so that no frame is labelled for it");
  }
};

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
    v.group("depth_noise", motion.rigid.depth_noise);
    v.group("segmentation", segmentation);
    v.group("removal", removal);
    waits.visit(v);
    slam.visit(v);  // tracking, mapping and optimisation are top-level groups
    v.group("dense", dense);
    v.group("depth_noise", dense.keyframe.depth_noise);
    inputs.visit(v);
    v.field("label_delay_s", label_delay_s, 0.0, 60.0,
            "labels reach the motion stage at least this long after their image, s: to measure what late masks cost");
  }
};

}  // namespace semantic_vslam
