// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/tracking_publisher.h"

#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <nav_msgs/Path.h>
#include <semantic_vslam/KeyframePoseArray.h>
#include <semantic_vslam/KeyframeStamped.h>

#include <algorithm>
#include <utility>

#include "ros/conversions.h"
#include "ros/tracking_markers.h"
#include "semantic_vslam/core/common/log.h"

namespace semantic_vslam {
namespace {

// rviz draws more poses than this no better, and a long run must not fill the network with its path.
constexpr std::size_t kLongestPath = 2000;

static_assert(static_cast<int>(TrackingState::kInitialising) == TrackingReport::INITIALISING &&
              static_cast<int>(TrackingState::kOk) == TrackingReport::OK &&
              static_cast<int>(TrackingState::kRecentlyLost) == TrackingReport::RECENTLY_LOST &&
              static_cast<int>(TrackingState::kLost) == TrackingReport::LOST);

SE3 transformOf(const InitialPoseConfig& pose) {
  const Eigen::Quaterniond rotation = Eigen::AngleAxisd(pose.yaw, Eigen::Vector3d::UnitZ()) *
                                      Eigen::AngleAxisd(pose.pitch, Eigen::Vector3d::UnitY()) *
                                      Eigen::AngleAxisd(pose.roll, Eigen::Vector3d::UnitX());
  return makeSE3(rotation, Eigen::Vector3d(pose.x, pose.y, pose.z));
}

// Longer than any frame takes on a machine that keeps up.
const ros::WallDuration kIdleAfter(1.0);

bool isIdle(std::uint8_t state) { return state == TrackingReport::WAITING || state == TrackingReport::PAUSED; }

std::string nameOf(std::uint8_t state) {
  if (state == TrackingReport::WAITING) return "WAITING";
  return state == TrackingReport::PAUSED ? "PAUSED" : stateName(static_cast<TrackingState>(state));
}

/// Mean velocity since the last tracked frame, in the body's axes.
geometry_msgs::TwistWithCovariance bodyVelocity(const TrackingEstimate& tracking, const SE3& T_camera_body) {
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

TrackingPublisher::TrackingPublisher(ros::NodeHandle nh, const FramesConfig& frames,
                                     const InitialPoseConfig& initial_pose, const PeopleConfig& people,
                                     double path_period_s, std::uint32_t first_map_id)
    : frames_(frames),
      initial_pose_(initial_pose),
      path_period_s_(path_period_s),
      tf_(nh, frames),
      people_(nh, people, frames.map_frame),
      map_id_(first_map_id) {
  odometry_ = nh.advertise<nav_msgs::Odometry>("tracking/odometry", 30);
  pose_ = nh.advertise<geometry_msgs::PoseWithCovarianceStamped>("tracking/pose", 30);
  path_ = nh.advertise<nav_msgs::Path>("tracking/path", 1, true);
  state_ = nh.advertise<TrackingReport>("tracking/state", 30, true);
  keyframe_ = nh.advertise<KeyframeStamped>("tracking/keyframe", 30);
  keyframe_poses_ = nh.advertise<KeyframePoseArray>("tracking/keyframe_poses", 1, true);
  keyframe_arrows_ = nh.advertise<geometry_msgs::PoseArray>("tracking/keyframe_arrows", 1, true);
  state_marker_ = nh.advertise<visualization_msgs::Marker>("tracking/state_marker", 1);
  points_ = nh.advertise<sensor_msgs::PointCloud2>("tracking/points", 1);
}

bool TrackingPublisher::locateBody(const RgbdFrame& frame) {
  const std::optional<SE3> T_camera_body = tf_.lookUpBody(headerOf(frame));
  if (T_camera_body) T_camera_body_ = *T_camera_body;
  return T_camera_body.has_value();
}

void TrackingPublisher::anchorNextMap(const std::optional<SE3>& T_map_world) {
  const std::lock_guard<std::mutex> lock(mutex_);
  next_T_map_world_ = T_map_world ? T_map_world : T_map_world_;
}

std::optional<SE3> TrackingPublisher::anchor() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return T_map_world_;
}

TrackingWishes TrackingPublisher::wishes(Stamp now) const {
  const bool path_is_due = now < last_path_ || secondsBetween(last_path_, now) >= path_period_s_;
  return {path_is_due && path_.getNumSubscribers() > 0 ? kLongestPath : 0, points_.getNumSubscribers() > 0};
}

/// Call with mutex_ held. Of another map than before it is not known yet where its world lies.
/// @return false: the map was left already
bool TrackingPublisher::follow(const MapSnapshot& map) {
  if (static_cast<std::int32_t>(map.map_id - map_id_) < 0) return false;
  if (map.map_id != map_id_) T_map_world_ = std::exchange(next_T_map_world_, std::nullopt);
  map_id_ = map.map_id;
  return true;
}

void TrackingPublisher::publish(const TrackingInput& input, const TrackingOutput& output, StepTime time) {
  const std_msgs::Header image = headerOf(input.frame);
  std::optional<MapSnapshot> waited;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    newest_image_ = input.frame.stamp;
    follow(*output.map);
    // Without a base frame the body is the camera itself, level and looking forward.
    const SE3 T_body_camera = frames_.base_frame.empty() ? bodyFromOptical() : T_camera_body_.inverse();
    if (!T_map_world_) T_map_world_ = transformOf(initial_pose_) * T_body_camera;
    frame_T_map_world_ = *T_map_world_;
    waited.swap(not_anchored_);
  }
  const TrackingState state = output.tracking.state;
  if (state == TrackingState::kOk || state == TrackingState::kRecentlyLost) publishPose(image, output.tracking);
  publishKeyframes(image, output);
  if (!output.path.empty()) publishPath(image, output.path);
  publishState(image, input, output, time);
  if (const auto line = sight_.next(input.frame.stamp, output)) log(line->level, line->text);
  if (waited) publishMap(*waited);
  if (state == TrackingState::kOk) {
    people_.publish(image, input.frame, input.motion.dynamic,
                    frame_T_map_world_ * output.tracking.T_camera_world.inverse());
  }
}

void TrackingPublisher::publishPose(const std_msgs::Header& image, const TrackingEstimate& tracking) {
  const SE3 T_map_camera = frame_T_map_world_ * tracking.T_camera_world.inverse();
  const SE3 T_map_body = T_map_camera * T_camera_body_;
  tf_.publish(image, T_map_body);

  nav_msgs::Odometry odometry;
  odometry.header.stamp = image.stamp;
  odometry.header.frame_id = frames_.map_frame;
  odometry.child_frame_id = tf_.bodyFrame(image);
  odometry.pose.pose = toPose(T_map_body);
  odometry.pose.covariance = bodyCovariance(tracking.covariance, T_map_camera, T_camera_body_);
  odometry.twist = bodyVelocity(tracking, T_camera_body_);
  odometry_.publish(odometry);

  geometry_msgs::PoseWithCovarianceStamped pose;
  pose.header = odometry.header;
  pose.pose = odometry.pose;
  pose_.publish(pose);
}

void TrackingPublisher::publishKeyframes(const std_msgs::Header& image, const TrackingOutput& output) {
  const std::vector<KeyframePose>& poses = output.map->poses;
  for (const KeyframeNotice& notice : output.keyframes) {
    const auto placed =
        std::find_if(poses.begin(), poses.end(), [&](const KeyframePose& pose) { return pose.keyframe == notice.id; });
    KeyframePose pose{notice.id, notice.stamp, SE3::Identity()};
    if (placed != poses.end()) pose.T_world_camera = frame_T_map_world_ * placed->T_world_camera;
    KeyframeStamped message = toRos(pose, frames_.map_frame, notice.map_id);
    message.placed = placed != poses.end();
    keyframe_.publish(message);
  }
  if (output.points.empty()) return;
  std::vector<Eigen::Vector3d> points = output.points;
  for (Eigen::Vector3d& point : points) point = frame_T_map_world_ * point;
  std_msgs::Header header = image;
  header.frame_id = frames_.map_frame;
  points_.publish(toRos(points, header));
}

void TrackingPublisher::publishMap(const MapSnapshot& map) {
  const std::lock_guard<std::mutex> one_after_the_other(map_mutex_);
  KeyframePoseArray message;
  SE3 T_map_world = SE3::Identity();
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!follow(map)) return;
    if (!T_map_world_ && map.keyframes() > 0) {
      not_anchored_ = map;
      return;
    }
    if (T_map_world_) T_map_world = *T_map_world_;
    newest_.keyframes = static_cast<std::uint32_t>(map.keyframes());
    newest_.landmarks = static_cast<std::uint32_t>(map.landmarks);
    if (isIdle(newest_.state)) publishIdle(newest_.state);
    loops_ = map.loops;
    message.header.stamp = map.keyframes() > 0 ? toRos(newest_image_) : ros::Time();
  }
  if (map.map_id == published_.map_id && map.version < published_.version) return;
  published_ = {map.map_id, map.origin, map.version, {}, {}};
  message.header.frame_id = frames_.map_frame;
  message.map_id = map.map_id;
  message.origin = map.origin;
  for (KeyframePose pose : map.poses) {
    pose.T_world_camera = T_map_world * pose.T_world_camera;
    message.keyframes.push_back(toRos(pose, frames_.map_frame, map.map_id));
  }
  for (const KeyframeId id : map.unplaced) {
    message.keyframes.push_back(toRos(KeyframePose{id, Stamp(), SE3::Identity()}, frames_.map_frame, map.map_id));
    message.keyframes.back().placed = false;
  }
  keyframe_poses_.publish(message);
  keyframe_arrows_.publish(toPoseArray(message));
}

void TrackingPublisher::publishPath(const std_msgs::Header& image, std::vector<TimedPose> poses) {
  last_path_ = fromRos(image.stamp);
  nav_msgs::Path path;
  path.header.stamp = image.stamp;
  path.header.frame_id = frames_.map_frame;
  for (const TimedPose& timed : inMap(std::move(poses))) {
    geometry_msgs::PoseStamped pose;
    pose.header.stamp = toRos(timed.stamp);
    pose.header.frame_id = frames_.map_frame;
    pose.pose = toPose(timed.T_world_camera);
    path.poses.push_back(pose);
  }
  path_.publish(path);
}

void TrackingPublisher::publishState(const std_msgs::Header& image, const TrackingInput& input,
                                     const TrackingOutput& output, StepTime time) {
  TrackingReport message;
  message.header = image;
  message.state = static_cast<std::uint8_t>(output.tracking.state);
  message.has_mask = !input.motion.dynamic.empty();
  message.is_keyframe = output.is_keyframe;
  message.features = static_cast<std::uint32_t>(output.tracking.features);
  message.inliers = static_cast<std::uint32_t>(output.tracking.inliers);
  message.keyframes = static_cast<std::uint32_t>(output.map->keyframes());
  message.landmarks = static_cast<std::uint32_t>(output.map->landmarks);
  if (!output.removed.empty()) {
    message.dynamic_share = static_cast<float>(cv::countNonZero(output.removed >= 128)) / output.removed.total();
  }
  message.camera = toPose(frame_T_map_world_ * output.tracking.T_camera_world.inverse());
  message.beside_keyframe = output.place.has_value();
  if (output.place) {
    message.keyframe = output.place->keyframe.value();
    message.map_id = output.place->map_id;
    message.in_keyframe = toPose(output.place->T_keyframe_camera);
  }
  message.cpu_ms = static_cast<float>(time.cpu_ms);
  const std::lock_guard<std::mutex> lock(mutex_);
  last_frame_ = ros::SteadyTime::now();
  const bool posed = message.state == TrackingReport::OK || message.state == TrackingReport::RECENTLY_LOST;
  ++(posed ? posed_ : lost_);
  if (posed) newest_place_ = message.camera.position;
  tell(std::move(message));
}

/// Call with mutex_ held.
void TrackingPublisher::tell(TrackingReport report) {
  state_.publish(report);
  if (state_marker_.getNumSubscribers() > 0) {
    state_marker_.publish(toMarker(report, nameOf(report.state), newest_place_, frames_.map_frame));
  }
  newest_ = std::move(report);
}

void TrackingPublisher::tellIdle(bool paused) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const std::uint8_t idle = paused ? TrackingReport::PAUSED : TrackingReport::WAITING;
  const bool goes_on = !isIdle(newest_.state) && ros::SteadyTime::now() - last_frame_ < kIdleAfter;
  if (newest_.state != idle && (paused || !goes_on)) publishIdle(idle);
}

/// Call with mutex_ held.
void TrackingPublisher::publishIdle(std::uint8_t state) {
  TrackingReport message;
  message.header.stamp = ros::Time::now();
  message.header.frame_id = newest_.header.frame_id;
  message.state = state;
  message.keyframes = newest_.keyframes;
  message.landmarks = newest_.landmarks;
  message.camera.orientation.w = 1.0;
  tell(std::move(message));
}

void TrackingPublisher::report(StageDiagnostics& diagnostics, StageDiagnostics::Status& status) const {
  {
    std::lock_guard<std::mutex> lock(mutex_);
    status.add("state", nameOf(newest_.state));
    status.add("inliers", newest_.inliers);
    status.add("keyframes", newest_.keyframes);
    status.add("landmarks", newest_.landmarks);
    status.add("loops closed", loops_);
    status.add("frames with a pose", posed_);
    status.add("frames without", lost_);
    if (newest_.state == TrackingReport::LOST) status.mergeSummary(diagnostic_msgs::DiagnosticStatus::ERROR, "lost");
  }
  status.add("transforms sent", tf_.sent());
  diagnostics.addFault(status, "transforms not found", tf_.failedLookups(), tf_.lastFailure());
  diagnostics.addFault(status, "transforms withheld", tf_.withheld(), tf_.lastWithheld());
}

std::vector<TimedPose> TrackingPublisher::inMap(std::vector<TimedPose> poses) const {
  std::lock_guard<std::mutex> lock(mutex_);
  if (!T_map_world_) return {};
  for (TimedPose& pose : poses) pose.T_world_camera = *T_map_world_ * pose.T_world_camera;
  return poses;
}

}  // namespace semantic_vslam
