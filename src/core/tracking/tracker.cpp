// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/tracking/tracker.h"

#include <algorithm>
#include <utility>

#include "semantic_vslam/core/common/config_fields.h"

namespace semantic_vslam {

const char* stateName(TrackingState state) {
  switch (state) {
    case TrackingState::kInitialising: return "INITIALISING";
    case TrackingState::kOk: return "OK";
    case TrackingState::kRecentlyLost: return "RECENTLY_LOST";
    case TrackingState::kLost: return "LOST";
  }
  return "?";
}

Tracker::Tracker(const TrackerConfig& config)
    : config_(config), orb_(config.orb), initializer_(config.initializer, config.frame) {
  validateConfig(config_);
  validateConfig(config_.frame.sensor);
}

TrackedFrame Tracker::prepare(const RgbdFrame& frame, const cv::Mat1b& dynamic) const {
  return TrackedFrame(frame, orb_.extract(frame, dynamic));
}

TrackingResult Tracker::track(TrackedFrame frame, const Map& map, bool mapper_idle) {
  if (state_ == TrackingState::kInitialising) return initialise(std::move(frame));

  if (!last_) return trackingFailed(frame);
  PoseEstimate estimate = followLastFrame(map, frame);
  TrackingResult result;
  if (estimate.success) estimate = followLocalMap(map, frame, result);
  if (!estimate.success || estimate.inliers < config_.min_inliers) return trackingFailed(frame);

  result.state = state_ = TrackingState::kOk;
  lost_since_.reset();
  initializer_.reset();  // what it kept while the camera was lost is old the next time
  result.T_camera_world = frame.T_camera_world;
  result.covariance = estimate.covariance;
  result.reference = reference_;
  result.features = static_cast<int>(frame.features->size());
  result.matches = estimate.matches;
  result.inliers = estimate.inliers;
  most_tracked_ = std::max(most_tracked_, estimate.inliers);
  result.keyframe_is_due = keyframeIsDue(map, frame, estimate.inliers, mapper_idle);
  const auto frames_between = static_cast<double>(frame.index - last_->index);
  const SE3 T_current_last = frame.T_camera_world * last_->T_camera_world.inverse();
  velocity_ = interpolate(SE3::Identity(), T_current_last, 1.0 / std::max(1.0, frames_between));
  const double seconds = secondsBetween(last_->stamp, frame.stamp);
  if (seconds > 0.0) result.last_step = CameraStep{T_current_last, seconds};
  last_ = std::move(frame);
  return result;
}

TrackingResult Tracker::initialise(TrackedFrame frame) {
  TrackingResult result;
  result.features = static_cast<int>(frame.features->size());
  result.first_frame = initializer_.offer(frame);
  return result;
}

std::optional<TrackedFrame> Tracker::offerForNewMap(TrackedFrame frame, double mapped_s) {
  constexpr double kLeastPatienceS = 1.0;  // who passes close by covers the view for so long
  const double patience_s = std::min(config_.new_map_after_s, std::max(kLeastPatienceS, mapped_s));
  if (!lost_since_ || secondsBetween(*lost_since_, frame.stamp) < patience_s) return std::nullopt;
  return initializer_.offer(frame);
}

PoseEstimate Tracker::followLastFrame(const Map& map, TrackedFrame& frame) const {
  const SE3 start = last_->T_camera_world;
  const double frames_between = static_cast<double>(frame.index - last_->index);
  const bool velocity_holds = velocity_ && secondsBetween(last_->stamp, frame.stamp) <= config_.recently_lost_s;
  const SE3 predicted = velocity_holds ? interpolate(SE3::Identity(), *velocity_, frames_between) * start : start;
  PoseEstimate estimate = trackFromLastFrame(map, *last_, predicted, config_.frame, frame);
  if (estimate.success) return estimate;
  if (const Keyframe* reference = map.keyframe(reference_)) {
    estimate = trackFromKeyframe(map, *reference, start, config_.frame, frame);
  }
  return estimate;
}

PoseEstimate Tracker::followLocalMap(const Map& map, TrackedFrame& frame, TrackingResult& result) {
  const LocalMap local_map = selectLocalMap(map, frame, config_.local_map);
  if (local_map.keyframes.empty()) return {};
  const double virtual_bf_px_m = frame.camera->fx() * config_.frame.sensor.virtual_baseline_m;
  result.visible = matchLocalMap(map, local_map, virtual_bf_px_m, config_.local_map, frame);
  const PoseEstimate estimate = refinePose(map, config_.frame, frame);
  if (!estimate.success) return estimate;
  reference_ = local_map.reference;
  for (const LandmarkId id : frame.landmarks) {
    if (id.valid()) result.found.push_back(id);
  }
  return estimate;
}

TrackingResult Tracker::trackingFailed(TrackedFrame& frame) {
  if (!lost_since_) lost_since_ = frame.stamp;
  TrackingResult result;
  result.features = static_cast<int>(frame.features->size());
  result.reference = reference_;
  const double since_s = last_ ? secondsBetween(last_->stamp, frame.stamp) : config_.recently_lost_s;
  const bool recently = last_ && velocity_ && since_s <= config_.recently_lost_s;
  result.state = state_ = recently ? TrackingState::kRecentlyLost : TrackingState::kLost;
  if (state_ == TrackingState::kRecentlyLost) {
    const double frames_between = static_cast<double>(frame.index - last_->index);
    result.T_camera_world = interpolate(SE3::Identity(), *velocity_, frames_between) * last_->T_camera_world;
    // A hand's acceleration of about 1 m/s^2 and 1 rad/s^2, left unseen for since_s.
    const double sigma = 0.5 * since_s * since_s + 0.01;
    result.covariance = sigma * sigma * Matrix6d::Identity();
  } else {
    velocity_.reset();
  }
  return result;
}

bool Tracker::keyframeIsDue(const Map& map, const TrackedFrame& frame, int inliers, bool mapper_idle) const {
  if (!map.keyframe(reference_)) return true;
  KeyframeEvidence evidence;
  evidence.frames_since_keyframe = static_cast<int>(frame.index - last_keyframe_index_);
  evidence.tracked = inliers;
  evidence.most_tracked = most_tracked_;
  evidence.mapper_idle = mapper_idle;
  countClose(frame, config_.frame.sensor.closeM(), evidence);
  return semantic_vslam::keyframeIsDue(evidence, config_.keyframe);
}

void Tracker::keyframeInserted(const Map& map, KeyframeId id) {
  reference_ = id;
  last_->landmarks = map.keyframe(id)->landmarks;
  last_keyframe_index_ = last_->index;
  most_tracked_ = 0;
}

void Tracker::startFrom(TrackedFrame frame, KeyframeId reference) {
  state_ = TrackingState::kOk;
  initializer_.reset();
  velocity_.reset();
  lost_since_.reset();
  last_keyframe_index_ = frame.index;
  most_tracked_ = 0;
  last_ = std::move(frame);
  reference_ = reference;
}

void Tracker::followReference(const SE3& T_reference_world_before, const SE3& T_reference_world_after) {
  if (last_) {
    last_->T_camera_world = last_->T_camera_world * T_reference_world_before.inverse() * T_reference_world_after;
  }
}

void Tracker::awaitRelocalisation() {
  reset();
  state_ = TrackingState::kLost;
}

void Tracker::reset() {
  initializer_.reset();
  state_ = TrackingState::kInitialising;
  last_.reset();
  velocity_.reset();
  lost_since_.reset();
  reference_ = KeyframeId();
  last_keyframe_index_ = 0;
  most_tracked_ = 0;
}

}  // namespace semantic_vslam
