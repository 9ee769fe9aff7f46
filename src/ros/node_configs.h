// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "core/people/people_config.h"
#include "semantic_vslam/core/common/config_fields.h"
#include "semantic_vslam/core/dense/dense_config.h"
#include "semantic_vslam/core/pipeline/config.h"

/// The keys of the nodes: those of the stage that each runs, and those that only nodes have. A key means the same in
/// every node that takes it, so that one file can hold those of all (AnyConfig).
namespace semantic_vslam {

/// How a nodelet takes its images in.
struct RgbdInputConfig {
  std::string camera_file;
  bool rectified = true;
  std::string sync = "approximate";
  double max_interval_s = 0.020;
  int queue_size = 5;
  double silent_after_s = 5.0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.text("camera_file", camera_file,
           "cfg/cameras/*.yaml that replaces camera_info, for drivers and bags without a calibration; empty: none");
    v.flag("rectified", rectified,
           "true: images are rectified, P of camera_info holds; false: raw images, K and D hold. A camera_file always "
           "holds as it is");
    v.choice("sync", sync, {"approximate", "exact"}, "exact: for drivers that stamp colour and depth equally");
    v.field("max_interval_s", max_interval_s, 0.0, 0.1,
            "s between colour and depth of a pair; in 20 ms a walker moves 2 cm, and 30 Hz streams always find a pair");
    v.field("queue_size", queue_size, 1, 100, "pairs that wait for the worker; the oldest is dropped when full");
    v.field("silent_after_s", silent_after_s, 0.5, 60.0, "s without a pair until the missing topics are named");
  }
};

/// For stages that are told late which frames they need.
struct KeptInputConfig {
  int kept_frames = 30;
  RgbdInputConfig input;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field(
        "kept_frames", kept_frames, 2, 300,
        "newest images that wait for the tracker to name one of them; 30 are a second and 75 MB at 640x480, once in a "
        "manager of nodelets");
    v.group("input", input);
  }
};

/// The frame that all maps are in.
struct MapFrameConfig {
  std::string map_frame = "map";

  template <class Visitor>
  void visit(Visitor& v) {
    v.text("map_frame", map_frame, "the fixed frame, which tracking gives");
  }
};

/// The frames of the robot, REP 105.
struct FramesConfig : MapFrameConfig {
  std::string odom_frame;
  std::string base_frame;
  bool publish_tf = true;
  double tf_wait_s = 0.05;
  double tf_future_s = 0.0;

  template <class Visitor>
  void visit(Visitor& v) {
    MapFrameConfig::visit(v);
    v.text("odom_frame", odom_frame, "odometry of the robot: map -> odom is published; empty: map -> base or camera");
    v.text("base_frame", base_frame, "body of the robot, joined to the camera by tf; empty: the camera is the body");
    v.flag("publish_tf", publish_tf, "false: only topics; another node broadcasts");
    v.field(
        "tf_wait_s", tf_wait_s, 0.0, 1.0,
        "s to wait for base -> camera of the image's stamp, where that joint moves; once in vain, no more until it is "
        "there. Nothing waits for odometry");
    v.field("tf_future_s", tf_future_s, 0.0, 1.0,
            "s by which map -> odom is dated ahead, so that others can use it before the next image");
  }
};

/// Where the body is in the map when tracking begins.
struct InitialPoseConfig {
  double x = 0, y = 0, z = 0, roll = 0, pitch = 0, yaw = 0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("x", x, -1e6, 1e6, "m");
    v.field("y", y, -1e6, 1e6, "m");
    v.field("z", z, -1e6, 1e6, "m; the camera's height if there is no base_frame and z = 0 is to be the floor");
    v.field("roll", roll, -M_PI, M_PI, "rad, about x (forward)");
    v.field("pitch", pitch, -M_PI, M_PI, "rad, about y (left); positive looks down");
    v.field("yaw", yaw, -M_PI, M_PI, "rad, about z (up)");
  }
};

/// Where maps are kept.
struct FoldersConfig {
  std::string output_directory = "~";
  std::string map;

  template <class Visitor>
  void visit(Visitor& v) {
    v.text(
        "output_directory", output_directory,
        "folder that the save services write to and ~load_map of tracking reads from; made if need be, ~ is the home "
        "folder");
    v.text("map", map, "folder with a saved map (map.slam, map.dense) to go on in; empty: a new one");
  }
};

struct MotionNodeConfig {
  double budget_ms = 33.0;
  RgbdInputConfig input;
  MotionConfig motion;
  RemovalConfig removal;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("budget_ms.motion", budget_ms, 1.0, 10000.0,
            "ms a frame may take before the diagnostics warn; 33 keeps 30 Hz");
    v.group("input", input);
    v.group("motion", motion);
    v.group("depth_noise", motion.rigid.depth_noise);
    v.group("removal", removal);
  }
};

struct TrackingNodeConfig {
  double budget_ms = 33.0;
  double path_period_s = 0.5;
  bool localization_only = false;
  FoldersConfig folders;
  TrackingWaits waits;
  RgbdInputConfig input;
  FramesConfig frames;
  InitialPoseConfig initial_pose;
  RemovalConfig removal;
  PeopleConfig people;
  SparseSlamConfig slam;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("budget_ms.tracking", budget_ms, 1.0, 10000.0,
            "ms a frame may take before the diagnostics warn; 33 keeps 30 Hz");
    v.field("path_period_s", path_period_s, 0.05, 60.0, "s between publications of the path");
    v.flag("localization_only", localization_only,
           "true: begins in localisation only, in the map of the key map, which is read and stays as it is; the "
           "service of "
           "this name ends it");
    folders.visit(v);
    waits.visit(v);
    v.group("input", input);
    v.group("frames", frames);
    v.group("initial_pose", initial_pose);
    v.group("removal", removal);
    v.group("people", people);
    slam.visit(v);  // tracking and mapping, as in a configuration file
  }
};

struct SegmentationNodeConfig {
  double budget_ms = 500.0;
  KeptInputConfig images;
  SegmentationConfig segmentation;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("budget_ms.segmentation", budget_ms, 1.0, 10000.0,
            "ms a keyframe may take before the diagnostics warn; keyframes come about twice a second");
    images.visit(v);
    v.group("segmentation", segmentation);
  }
};

struct MappingNodeConfig {
  double budget_ms = 300.0;
  double publish_period_s = 1.0;
  FoldersConfig folders;
  KeyframeInputsConfig inputs;
  KeptInputConfig images;
  MapFrameConfig frames;
  RemovalConfig removal;
  DenseConfig dense;
  MapObjectsConfig objects;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("budget_ms.mapping", budget_ms, 1.0, 10000.0, "ms a keyframe may take before the diagnostics warn");
    v.field("publish_period_s", publish_period_s, 0.1, 60.0, "s between publications of a map that changes");
    folders.visit(v);
    inputs.visit(v);
    images.visit(v);
    v.group("frames", frames);
    v.group("removal", removal);
    v.group("dense", dense);
    v.group("depth_noise", dense.keyframe.depth_noise);
    v.group("objects", objects);
  }
};

/// The keys of all nodes and of run_offline together: what a configuration file may hold.
struct AnyConfig {
  SystemConfig offline;
  MotionNodeConfig motion;
  TrackingNodeConfig tracking;
  SegmentationNodeConfig segmentation;
  MappingNodeConfig mapping;

  template <class Visitor>
  void visit(Visitor& v) {
    offline.visit(v);
    motion.visit(v);
    tracking.visit(v);
    segmentation.visit(v);
    mapping.visit(v);
  }
};

/// Reads a configuration file, which may hold keys of AnyConfig, and checks all of it.
/// @return the entries that one of `known` names, in the file's order
/// @throws FileError for the file; ConfigError naming it and a key that nobody has, or that is mistyped or out of range
std::vector<std::pair<std::string, std::string>> readConfigFileFor(const std::vector<ConfigEntry>& known,
                                                                   const std::string& path);

/// Sets what the file says of the keys that `config` has. @throws see readConfigFileFor()
template <class Config>
void loadSharedConfigFile(Config& config, const std::string& path) {
  for (const auto& [key, value] : readConfigFileFor(listConfig(config), path)) setConfig(config, key, value);
}

}  // namespace semantic_vslam
