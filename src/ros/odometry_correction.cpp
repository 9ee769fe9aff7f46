// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/odometry_correction.h"

#include <tf2/exceptions.h>

#include <algorithm>

#include "ros/conversions.h"

namespace semantic_vslam {
namespace {

// Two seconds at 30 Hz. Odometry that is later than this is of no use, and an edge is worked out anew with each pose.
constexpr std::size_t kMostWaiting = 60;

}  // namespace

std::optional<OdometryCorrection::Edge> OdometryCorrection::add(const ros::Time& stamp, const SE3& T_map_body) {
  if (stamp <= newest_) {  // the clock was set back
    waiting_.clear();
    given_ = ros::Time();
    first_.reset();
    known_.reset();
  }
  newest_ = stamp;
  if (!first_) first_ = stamp;
  const bool behind = !waiting_.empty();
  waiting_.push_back({stamp, T_map_body});
  if (waiting_.size() > kMostWaiting) waiting_.pop_front();
  std::optional<Edge> edge = update();
  if (!edge && behind && T_map_odom_) edge = Edge{stamp, *T_map_odom_};
  if (edge) given_ = edge->stamp;
  return edge;
}

std::optional<OdometryCorrection::Edge> OdometryCorrection::update() {
  const auto known = std::find_if(waiting_.rbegin(), waiting_.rend(), [this](const Pose& pose) {
    return tf_.canTransform(base_frame_, odom_frame_, pose.stamp);
  });
  if (known == waiting_.rend()) return std::nullopt;
  const Pose pose = *known;
  SE3 T_body_odom;
  try {
    T_body_odom = fromRos(tf_.lookupTransform(base_frame_, odom_frame_, pose.stamp).transform);
  } catch (const tf2::TransformException&) {
    return std::nullopt;  // forgotten meanwhile; the next pose comes
  }
  waiting_.erase(waiting_.begin(), known.base());
  T_map_odom_ = pose.T_map_body * T_body_odom;
  known_ = pose.stamp;
  if (pose.stamp <= given_) return std::nullopt;
  given_ = pose.stamp;
  return Edge{pose.stamp, *T_map_odom_};
}

double OdometryCorrection::behindS() const {
  if (waiting_.empty()) return 0.0;
  return (newest_ - known_.value_or(*first_)).toSec();
}

}  // namespace semantic_vslam
