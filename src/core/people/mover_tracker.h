// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/people/mover.h"
#include "core/people/people_config.h"

namespace semantic_vslam {

/// Follows movers from frame to frame: a Kalman filter of constant velocity for each, nearest neighbours first.
class MoverTracker {
 public:
  /// @throws ConfigError
  explicit MoverTracker(const PeopleConfig& config);

  /// @return where those that are told of are expected in a frame; of two that would stand in each other the older one
  std::vector<Eigen::Vector2d> expected(Stamp stamp) const;
  /// @param views  of this frame, see findMovers()  @param stamp  later than the last one; else all are forgotten
  /// @return those that are confirmed and were seen in this frame, in the order of their ids
  std::vector<TrackedMover> update(const std::vector<MoverView>& views, Stamp stamp);
  void clear();

 private:
  struct Track {
    TrackedMover mover;
    Stamp first_seen;
    int seen = 0;
    double person_evidence = 0.0;  ///< -1..1
  };

  void predict(double seconds);
  void correct(Track& track, const MoverView& view, Stamp stamp) const;
  void begin(const MoverView& view, Stamp stamp);
  bool isConfirmed(const Track& track) const;

  PeopleConfig config_;
  std::vector<Track> tracks_;
  Stamp last_;
  std::uint32_t next_id_ = 1;
};

}  // namespace semantic_vslam
