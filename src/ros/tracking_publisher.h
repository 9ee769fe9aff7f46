// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nav_msgs/Odometry.h>
#include <ros/node_handle.h>
#include <semantic_vslam/TrackingReport.h>
#include <std_msgs/Header.h>

#include <atomic>
#include <cstdint>
#include <mutex>
#include <optional>
#include <vector>

#include "core/io/trajectory.h"
#include "core/pipeline/tracking_stage.h"
#include "core/runtime/step_clock.h"
#include "ros/node_configs.h"
#include "ros/people_publisher.h"
#include "ros/sight_log.h"
#include "ros/stage_diagnostics.h"
#include "ros/tf_publisher.h"

namespace semantic_vslam {

/// Publishes what tracking finds: tf and tracking/{odometry, pose, path, state, keyframe, keyframe_poses, points}, and
/// the people about, see PeoplePublisher. All of it comes from what a step gives; the map itself is never asked.
class TrackingPublisher {
 public:
  /// @param first_map_id  of the stage
  /// @param path_period_s  between publications of the path, in the images' time
  /// @throws ConfigError, see TfPublisher
  TrackingPublisher(ros::NodeHandle nh, const FramesConfig& frames, const InitialPoseConfig& initial_pose,
                    const PeopleConfig& people, double path_period_s, std::uint32_t first_map_id);

  /// Asks tf where the body is at a frame that will be tracked next; may wait. @return false: the frame cannot be used
  bool locateBody(const RgbdFrame& frame);
  /// What somebody looks at and is due now.
  TrackingWishes wishes(Stamp now) const;
  /// Publishes the frame whose body was located last. The first one of a new map puts its body at the initial pose.
  void publish(const TrackingInput& input, const TrackingOutput& output, StepTime time);
  /// Publishes keyframes that are new or have moved, unless their map was left. From any thread.
  void publishMap(const MapSnapshot& map);
  /// To be called now and then, and when `paused` changes: says so once if it is, or if no frame is tracked any more.
  void tellIdle(bool paused);
  /// The next map lies so, or as the present one does, not so that its first frame is at the initial pose.
  void anchorNextMap(const std::optional<SE3>& T_map_world);
  /// Where the present map's world lies in the map frame; nothing before its first frame.
  std::optional<SE3> anchor() const;

  /// @param poses  of the optical frame in the world  @return the same in the map; empty where no frame has a pose yet
  std::vector<TimedPose> inMap(std::vector<TimedPose> poses) const;
  /// Adds what was published last, from any thread.
  void report(StageDiagnostics& diagnostics, StageDiagnostics::Status& status) const;

 private:
  bool follow(const MapSnapshot& map);
  void publishPose(const std_msgs::Header& image, const TrackingEstimate& tracking);
  void publishKeyframes(const std_msgs::Header& image, const TrackingOutput& output);
  void publishPath(const std_msgs::Header& image, std::vector<TimedPose> path);
  void publishState(const std_msgs::Header& image, const TrackingInput& input, const TrackingOutput& output,
                    StepTime time);
  void publishIdle(std::uint8_t state);
  void tell(TrackingReport report);

  const FramesConfig frames_;
  const InitialPoseConfig initial_pose_;
  const double path_period_s_;
  TfPublisher tf_;
  PeoplePublisher people_;
  // Of tracking's thread only, at the frame in work.
  SE3 T_camera_body_ = SE3::Identity();
  SE3 frame_T_map_world_ = SE3::Identity();
  Stamp last_path_;
  SightLog sight_;

  mutable std::mutex mutex_;  // held for moments; guards these
  std::uint32_t map_id_;
  std::optional<SE3> T_map_world_, next_T_map_world_;
  std::optional<MapSnapshot> not_anchored_;  ///< to be published when the map has its place
  Stamp newest_image_;
  TrackingReport newest_;
  geometry_msgs::Point newest_place_;  ///< of the camera, in the map
  ros::SteadyTime last_frame_;
  std::size_t posed_ = 0, lost_ = 0, loops_ = 0;

  std::mutex map_mutex_;   // taken before mutex_
  MapSnapshot published_;  // guarded by map_mutex_; without poses
  ros::Publisher odometry_, pose_, path_, state_, keyframe_, keyframe_poses_, keyframe_arrows_, state_marker_, points_;
};

}  // namespace semantic_vslam
