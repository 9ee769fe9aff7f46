// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "semantic_vslam/core/camera/sensor_config.h"

namespace semantic_vslam {

/// Which of a keyframe's pixels become points of the dense map.
struct KeyframeCloudConfig {
  int stride_px = 2;
  double min_depth_m = 0.3;
  double max_depth_m = 4.0;
  MapDepthNoise depth_noise;
  double max_incidence_deg = 80.0;
  int dynamic_margin_px = 8;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("stride_px", stride_px, 1, 16,
            "every n-th pixel and row makes a point; 2 px at 2 m are 8 mm, finer than the map's voxels");
    v.field("min_depth_m", min_depth_m, 0.05, 5.0, "nearer depth is dropped: below the range of structured light");
    v.field("max_depth_m", max_depth_m, 0.5, 20.0,
            "farther depth is dropped: its noise grows with z^2 and passes a voxel of 3 cm (1 sigma) at 4 m");
    v.field(
        "max_incidence_deg", max_incidence_deg, 30.0, 89.0,
        "a depth step steeper than a plane seen at this angle is an edge; its pixels mix both sides and are dropped");
    v.field("dynamic_margin_px", dynamic_margin_px, 0, 100,
            "dropped around people and moving things: colour and depth are up to 16 ms apart, in which a walker at 2 m "
            "moves 6 px, and depth is wrong along outlines");
  }
};

/// The voxels of the dense map, and what makes them occupied or free.
struct VoxelMapConfig {
  double resolution_m = 0.03;
  double hit_probability = 0.7;
  double miss_probability = 0.35;
  double min_probability = 0.12;
  double max_probability = 0.97;
  int confirming_keyframes = 2;
  double free_range_m = 4.0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("resolution_m", resolution_m, 0.005, 1.0,
            "edge of a voxel; 3 cm tells a chair leg from none and is 3 sigma of a Kinect's depth at 2.3 m");
    v.field("hit_probability", hit_probability, 0.5, 0.99,
            "that a voxel is occupied, given one keyframe's point in it");
    v.field("miss_probability", miss_probability, 0.01, 0.5,
            "that a voxel is occupied, given one keyframe that looked through it");
    v.field("min_probability", min_probability, 0.001, 0.49,
            "lower bound; keeps a voxel ready to change (OctoMap's clamping)");
    v.field("max_probability", max_probability, 0.51, 0.999,
            "upper bound; at 0.97 a chair that was moved is gone after six keyframes that look through it");
    v.field("confirming_keyframes", confirming_keyframes, 1, 100,
            "a voxel that any keyframe looked through needs points from so many to be shown: no ghosts of walkers");
    v.field("free_range_m", free_range_m, 0.0, 20.0,
            "space is called free up to here; beyond, pose and depth errors pass a voxel and rays are far apart");
  }
};

/// The grid for navigation: a view from above on a band of heights.
struct OccupancyGridConfig {
  double resolution_m = 0.06;
  double floor_height_m = 0.0;
  double min_height_m = 0.10;
  double max_height_m = 1.80;
  double max_gap_m = 0.06;
  bool find_floor = true;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("resolution_m", resolution_m, 0.01, 1.0,
            "edge of a cell; at least sqrt(3) voxels, or a turned voxel grid leaves holes");
    v.field("floor_height_m", floor_height_m, -100.0, 100.0,
            "height of the floor in the map frame, where the map does not show one");
    v.field("min_height_m", min_height_m, -10.0, 10.0,
            "lower edge of the band above the floor that counts; above door sills and depth noise of the floor");
    v.field("max_height_m", max_height_m, -10.0, 10.0, "upper edge of the band: the robot's height and a margin");
    v.field(
        "max_gap_m", max_gap_m, 0.0, 10.0,
        "a cell is free if its whole band is known to be but for gaps up to this, two voxels; what stands edge-on to "
        "the camera, a desk top or a shelf, leaves a wider one");
    v.flag("find_floor", find_floor,
           "true: heights are counted from the floor that the map shows, where it lies at floor_height_m or below; "
           "false: from floor_height_m");
  }
};

/// Which labelled points of the cloud make one object.
struct MapObjectsConfig {
  double cell_m = 0.06;
  int min_points = 100;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("cell_m", cell_m, 0.01, 1.0,
            "points of one class belong together if their cubes of this edge touch; things nearer than that are one");
    v.field("min_points", min_points, 1, 1000000,
            "smaller ones are left out: 100 points of a cloud at 1 cm are a surface of 10 x 10 cm");
  }
};

/// The dense map: group `dense` of SystemConfig.
struct DenseConfig {
  bool enabled = true;
  double cloud_resolution_m = 0.01;
  double reanchor_translation_m = 0.01;
  double reanchor_rotation_deg = 0.5;
  int rebuild_keyframes_per_call = 4;
  int memory_mb = 512;
  KeyframeCloudConfig keyframe;
  VoxelMapConfig voxels;
  OccupancyGridConfig grid;

  template <class Visitor>
  void visit(Visitor& v) {
    v.flag("enabled", enabled, "false: no dense map is made");
    v.field("cloud_resolution_m", cloud_resolution_m, 0.002, 1.0,
            "one point of the cloud for each cube of this edge; 1 cm is the depth noise of a Kinect at 2.3 m");
    v.field("reanchor_translation_m", reanchor_translation_m, 0.0, 1.0,
            "the map is rebuilt when a keyframe's pose has moved by more than this; a third of a voxel");
    v.field("reanchor_rotation_deg", reanchor_rotation_deg, 0.0, 45.0,
            "or turned by more than this; 0.5 deg are 1.7 cm at 2 m");
    v.field("rebuild_keyframes_per_call", rebuild_keyframes_per_call, 1, 10000,
            "keyframes that one call adds again during a rebuild; each takes about as long as a new one");
    v.field(
        "memory_mb", memory_mb, 8, 1 << 16,
        "for all of it: kept keyframes, voxels, twice for rebuilds, and what is kept for publishing, 3 MB a m^2 of "
        "floor; above it the oldest clouds are thinned to half a voxel, then keyframes that the sparse map dropped "
        "are forgotten, then those farthest from the camera: what they saw follows no loop any more; at last voxels "
        "far from the camera");
    v.group("keyframe", keyframe);
    v.group("voxels", voxels);
    v.group("grid", grid);
  }
};

}  // namespace semantic_vslam
