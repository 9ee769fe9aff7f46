// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nav_msgs/Odometry.h>
#include <ros/node_handle.h>
#include <semantic_vslam/KeyframePoseArray.h>
#include <std_msgs/Header.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <mutex>
#include <optional>
#include <vector>

#include "core/pipeline/sparse_slam.h"
#include "ros/tf_publisher.h"
#include "semantic_vslam/core/io/trajectory.h"

namespace semantic_vslam {

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

  SE3 transform() const;
};

/// What tracking made of one frame, as its report needs it.
struct TrackedFrameReport {
  bool has_mask = false;
  double dynamic_share = 0.0;  ///< of the mask's pixels
  double cpu_ms = 0.0;
};

/// Publishes what tracking finds: tracking/{odometry, pose, path, state, keyframe, keyframe_poses, points} and tf.
/// Core poses, whose world is the first camera's optical frame, become poses in the map frame (z up) here and nowhere
/// else. The caller serialises all calls but lookUp(), and trajectory(), which any thread may make.
class TrackingPublisher {
 public:
  /// @param path_period_s  between publications of the path and of moved keyframes, in the images' time
  /// @throws ConfigError, see TfPublisher
  TrackingPublisher(ros::NodeHandle nh, const FramesConfig& frames, const InitialPoseConfig& initial_pose,
                    double path_period_s);

  /// See TfPublisher; without it a frame cannot be used. May wait; not serialised with the other calls.
  std::optional<BodyTransforms> lookUp(const std_msgs::Header& image) { return tf_.lookUp(image); }

  /// Publishes a frame. The first one after a reset puts its body at the initial pose.
  void publish(const std_msgs::Header& image, const BodyTransforms& body, const SparseStep& step,
               const SparseSlam& slam, const TrackedFrameReport& report);
  /// Where the world of a new map lies: as that of the last one, or so that the next frame is at the initial pose.
  enum class Anchor { kKeep, kAtNextFrame };
  /// The map was dropped or another was loaded: says so to whoever keeps its keyframes. Not during publish().
  void startMap(Anchor anchor);

  /// @param most  see SparseSlam::trajectory()  @return every frame's optical frame in the map.
  std::vector<TimedPose> trajectory(const SparseSlam& slam,
                                    std::size_t most = std::numeric_limits<std::size_t>::max()) const;
  const TfPublisher& tf() const { return tf_; }

 private:
  void anchorMap(const SE3& T_camera_body);
  void publishPose(const std_msgs::Header& image, const BodyTransforms& body, const TrackingResult& tracking);
  void publishKeyframes(const SparseStep& step, const SparseSlam& slam, const std_msgs::Header& image);
  void publishKeyframe(KeyframeId id, Stamp stamp, const KeyframePoseArray& poses, const SparseSlam& slam);
  void publishKeyframePoses(KeyframePoseArray poses);
  KeyframePoseArray keyframePoses(const SparseSlam& slam, const std_msgs::Header& image) const;
  void publishPaths(const std_msgs::Header& image, const SparseSlam& slam);
  void publishState(const std_msgs::Header& image, const SparseStep& step, const SparseSlam& slam,
                    const TrackedFrameReport& report);

  const FramesConfig frames_;
  const InitialPoseConfig initial_pose_;
  const double path_period_s_;
  TfPublisher tf_;
  std::uint32_t map_id_;
  mutable std::mutex mutex_;
  std::optional<SE3> T_map_world_;  // written by the publishing thread under mutex_; others read it so
  KeyframePoseArray last_keyframe_poses_;
  Stamp last_path_;
  ros::Publisher odometry_, pose_, path_, state_, keyframe_, keyframe_poses_, points_;
};

}  // namespace semantic_vslam
