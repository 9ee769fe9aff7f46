// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "semantic_vslam/core/camera/sensor_config.h"

namespace semantic_vslam {

/// Dense optical flow (DIS; Kroeger et al., ECCV 2016).
struct DenseFlowConfig {
  int width_px = 320;
  std::string preset = "ultrafast";
  std::string slow_preset = "medium";

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("width_px", width_px, 80, 1280,
            "width the image is reduced to, px (a multiple of 2); flow and masks are worked out in cells of 2 x 2 of "
            "these");
    v.choice("preset", preset, {"ultrafast", "fast", "medium"},
             "DIS preset, each dearer than the one before; at 30 Hz masks are as good with the first");
    v.choice("slow_preset", slow_preset, {"ultrafast", "fast", "medium"},
             "the same between frames more than 0.12 s apart (8 Hz): what moves goes farther, and there is time");
  }
};

/// The paper's model: one plane homography explains the camera's motion.
struct HomographyConfig {
  double theta_px = 4.0;
  double ransac_px = 1.5;
  int min_inliers = 30;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("theta_px", theta_px, 0.1, 100.0,
            "flow amplitude after the warp, eq. (1), above which a pixel moves; px of the full image per frame");
    v.field("ransac_px", ransac_px, 0.1, 20.0, "largest transfer error of an inlier, px of the full image");
    v.field("min_inliers", min_inliers, 8, 5000, "fewer inliers than this: no motion can be told in this frame");
  }
};

/// The rigid model: the camera's motion in space and the depth image explain the flow of everything that stands still.
struct RigidFlowConfig {
  double flow_sigma_px = 0.2;
  MotionDepthNoise depth_noise;
  double min_depth_margin_m = 0.04;
  int min_points = 60;
  double min_inlier_share = 0.35;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("flow_sigma_px", flow_sigma_px, 0.05, 5.0,
            "least standard deviation of the flow, px at flow.width_px (each frame measures its own)");
    v.field("min_depth_margin_m", min_depth_margin_m, 0.005, 0.5,
            "a surface counts as new in free space if it is nearer than what was seen there by this and 4 sigma, m");
    v.field("min_points", min_points, 10, 1000, "fewer points with depth: the flow is explained by a homography");
    v.field("min_inlier_share", min_inlier_share, 0.05, 0.95,
            "least share of the static points' weight that must agree with the camera's motion");
  }
};

/// Evidence carried from frame to frame with the flow.
struct MotionMemoryConfig {
  double time_constant_s = 0.5;
  double hold_s = 20.0;
  double reference_age_s = 3.0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("time_constant_s", time_constant_s, 0.02, 30.0, "weak evidence of motion falls to 1/e in this time, s");
    v.field("hold_s", hold_s, 0.1, 3600.0,
            "what surely moved and stopped stays dynamic for this long, s, where the map does not know it as still "
            "(room.settle_s says why)");
    v.field(
        "reference_age_s", reference_age_s, 0.1, 10.0,
        "oldest depth image that the present one is compared with, s; longer sees slower people, and for longer that "
        "somebody who came and stopped was not there before");
  }
};

/// The map's memory of free space: keyframes' depth at their poses in the map.
struct RoomMemoryConfig {
  int max_references = 64;
  double settle_s = 20.0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("max_references", max_references, 0, 100,
            "keyframes whose depth is kept (0.2 MB each at the default grid); 0: none");
    v.field(
        "settle_s", settle_s, 1.0, 3600.0,
        "what came and has stood still in keyframes for this long belongs to the room, s: people who stop to talk or "
        "to look stay for seconds, furniture for minutes; a person by a label never does");
  }
};

/// Cleaning of the binary mask. Lengths in px of the full image.
struct MaskCleanupConfig {
  int open_px = 9;
  int close_px = 21;
  int min_area_px = 1200;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("open_px", open_px, 0, 100, "diameter of the opening that removes specks, px");
    v.field("close_px", close_px, 0, 200, "diameter of the closing that fills gaps, px");
    v.field("min_area_px", min_area_px, 0, 1000000, "smallest moving region that is kept, px (a head at 4 m: 1200)");
  }
};

/// Semantic masks that arrive late and are carried to the present frame.
struct MaskPropagationConfig {
  double max_delay_s = 1.5;
  double time_constant_s = 2.0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("max_delay_s", max_delay_s, 0.1, 10.0, "masks later than this are ignored; bounds the flows kept, s");
    v.field("time_constant_s", time_constant_s, 0.1, 60.0,
            "trust in a carried mask falls to 1/e in this time after its image, s");
  }
};

/// The motion stage: group `motion` of SystemConfig.
struct MotionConfig {
  std::string model = "rigid_flow";
  DenseFlowConfig flow;
  HomographyConfig homography;
  RigidFlowConfig rigid;
  MotionMemoryConfig memory;
  RoomMemoryConfig room;
  MaskCleanupConfig cleanup;
  MaskPropagationConfig semantics;

  template <class Visitor>
  void visit(Visitor& v) {
    v.choice("model", model, {"none", "homography", "rigid_flow"},
             "what explains the camera's own motion; none: only semantic masks tell what is dynamic");
    v.group("flow", flow);
    v.group("homography", homography);
    v.group("rigid", rigid);
    v.group("memory", memory);
    v.group("room", room);
    v.group("cleanup", cleanup);
    v.group("semantics", semantics);
  }
};

}  // namespace semantic_vslam
