// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/people/mover_tracker.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <tuple>

#include "semantic_vslam/core/common/config_fields.h"

namespace semantic_vslam {
namespace {

constexpr double kGateChi2 = 9.21;      // two degrees of freedom, 99 %
constexpr double kGateM = 1.0;          // and never farther than this: another person
constexpr double kBodyM = 0.3;          // two bodies' axes are farther apart
constexpr double kStartSigmaMps = 1.0;  // people walk at 1 to 1.5 m/s
constexpr double kLongestStepS = 2.0;
constexpr double kSmoothing = 0.1;  // of size and class, a frame

}  // namespace

MoverTracker::MoverTracker(const PeopleConfig& config) : config_(config) { validateConfig(config_); }

void MoverTracker::clear() { tracks_.clear(); }

std::vector<Eigen::Vector2d> MoverTracker::expected(Stamp stamp) const {
  std::vector<Eigen::Vector2d> places;
  for (const Track& track : tracks_) {
    if (!isConfirmed(track)) continue;
    const Eigen::Vector2d place = track.mover.position + track.mover.velocity * secondsBetween(last_, stamp);
    const bool free =
        std::all_of(places.begin(), places.end(), [&](const auto& other) { return (other - place).norm() > kBodyM; });
    if (free) places.push_back(place);
  }
  return places;
}

std::vector<TrackedMover> MoverTracker::update(const std::vector<MoverView>& views, Stamp stamp) {
  const double seconds = secondsBetween(last_, stamp);
  if (tracks_.empty() || seconds <= 0.0 || seconds > kLongestStepS) {
    clear();
  } else {
    predict(seconds);
  }
  last_ = stamp;

  std::vector<std::tuple<double, std::size_t, std::size_t>> pairs;  // distance, track, view
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    for (std::size_t v = 0; v < views.size(); ++v) {
      const TrackedMover& mover = tracks_[t].mover;
      const Eigen::Vector2d off = views[v].position - mover.position;
      const Eigen::Matrix2d S =
          mover.covariance.topLeftCorner<2, 2>() + Eigen::Matrix2d::Identity() * views[v].sigma_m * views[v].sigma_m;
      const double chi2 = off.dot(S.inverse() * off);
      // What is half hidden seems to move aside by some of its width.
      const bool near = off.norm() < config_.radius_m || (chi2 < kGateChi2 && off.norm() < kGateM);
      if (near) pairs.emplace_back(off.norm(), t, v);
    }
  }
  std::sort(pairs.begin(), pairs.end());
  std::vector<bool> track_done(tracks_.size(), false), view_done(views.size(), false);
  for (const auto& [distance, t, v] : pairs) {
    if (track_done[t] || view_done[v]) continue;
    track_done[t] = view_done[v] = true;
    correct(tracks_[t], views[v], stamp);
  }
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (!view_done[v]) begin(views[v], stamp);
  }
  // Who was never confirmed is not waited for.
  tracks_.erase(std::remove_if(tracks_.begin(), tracks_.end(),
                               [&](const Track& track) {
                                 const double unseen = secondsBetween(track.mover.last_seen, stamp);
                                 return unseen > (isConfirmed(track) ? config_.keep_s : config_.confirm_s);
                               }),
                tracks_.end());
  std::vector<TrackedMover> movers;
  for (const Track& track : tracks_) {
    if (isConfirmed(track) && track.mover.last_seen == stamp) movers.push_back(track.mover);
  }
  return movers;
}

/// White acceleration (Bar-Shalom et al. 2001, section 6.2.2).
void MoverTracker::predict(double seconds) {
  Eigen::Matrix4d F = Eigen::Matrix4d::Identity();
  F.topRightCorner<2, 2>().diagonal().setConstant(seconds);
  const double q = config_.acceleration_mps2 * config_.acceleration_mps2, s2 = seconds * seconds;
  Eigen::Matrix4d Q = Eigen::Matrix4d::Zero();
  Q.topLeftCorner<2, 2>().diagonal().setConstant(q * s2 * s2 / 4);
  Q.topRightCorner<2, 2>().diagonal().setConstant(q * s2 * seconds / 2);
  Q.bottomLeftCorner<2, 2>().diagonal().setConstant(q * s2 * seconds / 2);
  Q.bottomRightCorner<2, 2>().diagonal().setConstant(q * s2);
  for (Track& track : tracks_) {
    track.mover.position += track.mover.velocity * seconds;
    track.mover.covariance = F * track.mover.covariance * F.transpose() + Q;
  }
}

void MoverTracker::correct(Track& track, const MoverView& view, Stamp stamp) const {
  TrackedMover& mover = track.mover;
  const Eigen::Matrix<double, 4, 2> PHt = mover.covariance.leftCols<2>();
  const Eigen::Matrix2d S =
      mover.covariance.topLeftCorner<2, 2>() + Eigen::Matrix2d::Identity() * view.sigma_m * view.sigma_m;
  const Eigen::Matrix<double, 4, 2> K = PHt * S.inverse();
  const Eigen::Vector4d change = K * (view.position - mover.position);
  mover.position += change.head<2>();
  mover.velocity += change.tail<2>();
  mover.covariance -= K * PHt.transpose();
  mover.covariance = (mover.covariance + mover.covariance.transpose()).eval() / 2;
  mover.bottom_m += kSmoothing * (view.bottom_m - mover.bottom_m);
  mover.top_m += kSmoothing * (view.top_m - mover.top_m);
  mover.width_m += kSmoothing * (view.width_m - mover.width_m);
  track.person_evidence += kSmoothing * ((view.isLikePerson() ? 1.0 : -1.0) - track.person_evidence);
  mover.person = track.person_evidence > 0.0;
  mover.last_seen = stamp;
  ++track.seen;
}

void MoverTracker::begin(const MoverView& view, Stamp stamp) {
  Track track;
  track.mover.id = next_id_++;
  track.mover.position = view.position;
  track.mover.covariance.setZero();
  track.mover.covariance.diagonal() << view.sigma_m * view.sigma_m, view.sigma_m * view.sigma_m,
      kStartSigmaMps * kStartSigmaMps, kStartSigmaMps * kStartSigmaMps;
  track.mover.bottom_m = view.bottom_m;
  track.mover.top_m = view.top_m;
  track.mover.width_m = view.width_m;
  track.person_evidence = view.isLikePerson() ? 1.0 : -1.0;
  track.mover.person = track.person_evidence > 0.0;
  track.mover.last_seen = track.first_seen = stamp;
  track.seen = 1;
  tracks_.push_back(track);
}

bool MoverTracker::isConfirmed(const Track& track) const {
  return track.seen >= 3 && secondsBetween(track.first_seen, track.mover.last_seen) >= config_.confirm_s;
}

}  // namespace semantic_vslam
