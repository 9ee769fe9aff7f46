// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/features/place_index.h"
#include "core/loop/loop_corrector.h"
#include "core/loop/loop_detector.h"
#include "core/loop/relocalizer.h"
#include "core/mapping/landmark_triangulation.h"
#include "core/mapping/map_maintenance.h"
#include "core/optimization/bundle_adjustment.h"
#include "core/tracking/tracker.h"

namespace semantic_vslam {

/// The configs of tracking, map upkeep, relocalisation and loop closing together.
struct SparseSlamConfig {
  TrackerConfig tracking;
  MapMaintenanceConfig mapping;
  TriangulationConfig triangulation;
  BaConfig local_ba;
  PlaceIndexConfig places;
  RelocalizerConfig relocalisation;
  bool close_loops = true;
  LoopDetectorConfig loop_detection;
  LoopCorrectorConfig loop_correction;

  template <class Visitor>
  void visit(Visitor& v) {
    v.group("sensor", tracking.frame.sensor);
    v.group("tracking", tracking);
    v.group("mapping", mapping);
    v.group("triangulation", triangulation);
    v.group("local_ba", local_ba);
    v.group("places", places);
    v.group("relocalisation", relocalisation);
    v.flag("close_loops", close_loops,
           "false: places seen again are not looked for; drift stays, and new maps are not joined with old ones");
    v.group("loop_detection", loop_detection);
    v.group("loop_correction", loop_correction);
  }
};

}  // namespace semantic_vslam
