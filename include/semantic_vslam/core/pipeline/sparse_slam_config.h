// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "semantic_vslam/core/features/features_config.h"
#include "semantic_vslam/core/loop/loop_config.h"
#include "semantic_vslam/core/mapping/mapping_config.h"
#include "semantic_vslam/core/optimization/optimization_config.h"
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

}  // namespace semantic_vslam
