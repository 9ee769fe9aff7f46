// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/tracking_publisher.h"

#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <nav_msgs/Path.h>
#include <semantic_vslam/KeyframeStamped.h>
#include <semantic_vslam/TrackingReport.h>

#include <algorithm>
#include <utility>

#include "ros/conversions.h"

namespace semantic_vslam {
namespace {

// rviz draws more poses than this no better, and a long run must not fill the network with its path.
constexpr std::size_t kLongestPath = 2000;

std::uint8_t stateCode(TrackingState state) {
  switch (state) {
    case TrackingState::kInitialising: return TrackingReport::INITIALISING;
    case TrackingState::kOk: return TrackingReport::OK;
    case TrackingState::kRecentlyLost: return TrackingReport::RECENTLY_LOST;
    case TrackingState::kLost: break;
  }
  return TrackingReport::LOST;
}

/// Mean velocity since the last tracked frame, in the body's axes.
geometry_msgs::TwistWithCovariance bodyVelocity(const TrackingResult& tracking, const SE3& T_camera_body) {
  geometry_msgs::TwistWithCovariance velocity;
  if (!tracking.last_step) {
    constexpr double kUnknown = 1e6;  // (m/s)^2, (rad/s)^2: a filter must not take this for standing still
    for (int i = 0; i < 6; ++i) velocity.covariance[7 * i] = kUnknown;
    return velocity;
  }
  const CameraStep& step = *tracking.last_step;
  const SE3 T_last_current_body = T_camera_body.inverse() * step.T_current_last.inverse() * T_camera_body;
  velocity.twist = toTwist(se3Log(T_last_current_body) / step.seconds);
  // The difference of two poses that are about as sure as each other.
  const Matrix6d covariance = 2.0 / (step.seconds * step.seconds) * tracking.covariance;
  velocity.covariance = bodyCovariance(covariance, T_camera_body.inverse(), T_camera_body);
  return velocity;
}

}  // namespace

SE3 InitialPoseConfig::transform() const {
  const Eigen::Quaterniond rotation = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
                                      Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) *
                                      Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX());
  return makeSE3(rotation, Eigen::Vector3d(x, y, z));
}

TrackingPublisher::TrackingPublisher(ros::NodeHandle nh, const FramesConfig& frames,
                                     const InitialPoseConfig& initial_pose, double path_period_s)
    : frames_(frames),
      initial_pose_(initial_pose),
      path_period_s_(path_period_s),
      tf_(nh, frames),
      // Ids of an earlier run of this node must not pass for ours with whoever kept its keyframes.
      map_id_(ros::WallTime::now().sec) {
  odometry_ = nh.advertise<nav_msgs::Odometry>("tracking/odometry", 30);
  pose_ = nh.advertise<geometry_msgs::PoseWithCovarianceStamped>("tracking/pose", 30);
  path_ = nh.advertise<nav_msgs::Path>("tracking/path", 1, true);
  state_ = nh.advertise<TrackingReport>("tracking/state", 30);
  keyframe_ = nh.advertise<KeyframeStamped>("tracking/keyframe", 30);
  keyframe_poses_ = nh.advertise<KeyframePoseArray>("tracking/keyframe_poses", 1, true);
  points_ = nh.advertise<sensor_msgs::PointCloud2>("tracking/points", 1);
}

void TrackingPublisher::startMap(Anchor anchor) {
  ++map_id_;
  if (anchor == Anchor::kAtNextFrame) {
    std::lock_guard<std::mutex> lock(mutex_);
    T_map_world_.reset();
  }
  KeyframePoseArray nothing;
  nothing.header.frame_id = frames_.map_frame;
  nothing.map_id = map_id_;
  publishKeyframePoses(nothing);
}

void TrackingPublisher::publish(const std_msgs::Header& image, const BodyTransforms& body, const SparseStep& step,
                                const SparseSlam& slam, const TrackedFrameReport& report) {
  anchorMap(body.T_camera_body);
  const TrackingState state = step.tracking.state;
  if (state == TrackingState::kOk || state == TrackingState::kRecentlyLost) {
    publishPose(image, body, step.tracking);
  }
  publishKeyframes(step, slam, image);
  publishPaths(image, slam);
  publishState(image, step, slam, report);
}

void TrackingPublisher::anchorMap(const SE3& T_camera_body) {
  std::lock_guard<std::mutex> lock(mutex_);
  if (T_map_world_) return;
  // Without a base frame the body is the camera itself, level and looking forward.
  T_map_world_ = initial_pose_.transform() * (frames_.base_frame.empty() ? bodyFromOptical() : T_camera_body.inverse());
}

void TrackingPublisher::publishPose(const std_msgs::Header& image, const BodyTransforms& body,
                                    const TrackingResult& tracking) {
  const SE3 T_map_camera = *T_map_world_ * tracking.T_camera_world.inverse();
  const SE3 T_map_body = T_map_camera * body.T_camera_body;
  tf_.publish(image, T_map_body, body.T_body_odom);

  nav_msgs::Odometry odometry;
  odometry.header.stamp = image.stamp;
  odometry.header.frame_id = frames_.map_frame;
  odometry.child_frame_id = tf_.bodyFrame(image);
  odometry.pose.pose = toPose(T_map_body);
  odometry.pose.covariance = bodyCovariance(tracking.covariance, T_map_camera, body.T_camera_body);
  odometry.twist = bodyVelocity(tracking, body.T_camera_body);
  odometry_.publish(odometry);

  geometry_msgs::PoseWithCovarianceStamped pose;
  pose.header = odometry.header;
  pose.pose = odometry.pose;
  pose_.publish(pose);
}

KeyframePoseArray TrackingPublisher::keyframePoses(const SparseSlam& slam, const std_msgs::Header& image) const {
  KeyframePoseArray poses;
  poses.header.stamp = image.stamp;
  poses.header.frame_id = frames_.map_frame;
  poses.map_id = map_id_;
  for (KeyframePose& pose : slam.keyframePoses()) {
    pose.T_world_camera = *T_map_world_ * pose.T_world_camera;
    poses.keyframes.push_back(toRos(pose, frames_.map_frame, map_id_));
  }
  return poses;
}

void TrackingPublisher::publishKeyframePoses(KeyframePoseArray poses) {
  keyframe_poses_.publish(poses);
  last_keyframe_poses_ = std::move(poses);
}

void TrackingPublisher::publishKeyframes(const SparseStep& step, const SparseSlam& slam,
                                         const std_msgs::Header& image) {
  if (!step.first_keyframe && !step.keyframe) return;
  const KeyframePoseArray poses = keyframePoses(slam, image);
  if (step.first_keyframe) publishKeyframe(*step.first_keyframe, step.first_stamp, poses, slam);
  if (step.keyframe) publishKeyframe(*step.keyframe, fromRos(image.stamp), poses, slam);
  publishKeyframePoses(poses);
  if (points_.getNumSubscribers() == 0) return;
  std::vector<Eigen::Vector3d> points = slam.landmarkPositions();
  for (Eigen::Vector3d& point : points) point = *T_map_world_ * point;
  points_.publish(toRos(points, poses.header));
}

/// Names a keyframe at once, also where its pose must wait for the new map to be joined: its images would be gone then.
void TrackingPublisher::publishKeyframe(KeyframeId id, Stamp stamp, const KeyframePoseArray& poses,
                                        const SparseSlam& slam) {
  const auto placed = std::find_if(poses.keyframes.begin(), poses.keyframes.end(),
                                   [&](const KeyframeStamped& keyframe) { return KeyframeId(keyframe.id) == id; });
  if (placed != poses.keyframes.end()) {
    keyframe_.publish(*placed);
  } else if (slam.holds(id)) {
    KeyframeStamped keyframe = toRos(KeyframePose{id, stamp, SE3::Identity()}, frames_.map_frame, map_id_);
    keyframe.placed = false;
    keyframe_.publish(keyframe);
  }
}

void TrackingPublisher::publishPaths(const std_msgs::Header& image, const SparseSlam& slam) {
  const Stamp now = fromRos(image.stamp);
  if (now > last_path_ && secondsBetween(last_path_, now) < path_period_s_) return;
  last_path_ = now;
  // Bundle adjustment and loops move keyframes long after they were published.
  KeyframePoseArray keyframes = keyframePoses(slam, image);
  if (keyframes.keyframes != last_keyframe_poses_.keyframes) publishKeyframePoses(std::move(keyframes));
  if (path_.getNumSubscribers() == 0) return;
  const std::vector<TimedPose> poses = trajectory(slam, kLongestPath);
  nav_msgs::Path path;
  path.header.stamp = image.stamp;
  path.header.frame_id = frames_.map_frame;
  for (const TimedPose& timed : poses) {
    geometry_msgs::PoseStamped pose;
    pose.header.stamp = toRos(timed.stamp);
    pose.header.frame_id = frames_.map_frame;
    pose.pose = toPose(timed.T_world_camera);
    path.poses.push_back(pose);
  }
  path_.publish(path);
}

void TrackingPublisher::publishState(const std_msgs::Header& image, const SparseStep& step, const SparseSlam& slam,
                                     const TrackedFrameReport& report) {
  TrackingReport message;
  message.header = image;
  message.state = stateCode(step.tracking.state);
  message.has_mask = report.has_mask;
  message.is_keyframe = step.keyframe.has_value();
  message.features = static_cast<std::uint32_t>(step.tracking.features);
  message.inliers = static_cast<std::uint32_t>(step.tracking.inliers);
  message.keyframes = static_cast<std::uint32_t>(slam.keyframeCount());
  message.landmarks = static_cast<std::uint32_t>(slam.landmarkCount());
  message.dynamic_share = static_cast<float>(report.dynamic_share);
  message.cpu_ms = static_cast<float>(report.cpu_ms);
  state_.publish(message);
}

std::vector<TimedPose> TrackingPublisher::trajectory(const SparseSlam& slam, std::size_t most) const {
  std::vector<TimedPose> poses = slam.trajectory(most);
  std::lock_guard<std::mutex> lock(mutex_);
  if (!T_map_world_) return {};
  for (TimedPose& pose : poses) pose.T_world_camera = *T_map_world_ * pose.T_world_camera;
  return poses;
}

}  // namespace semantic_vslam
