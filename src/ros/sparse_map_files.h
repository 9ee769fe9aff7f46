// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/publisher.h>

#include <string>

#include "core/runtime/tracking_runner.h"
#include "ros/recovery.h"
#include "ros/tracking_publisher.h"

namespace semantic_vslam {

/// What the tracking node keeps on disk: the sparse map, for its services and for the node that takes its place when it
/// is killed, and the trajectory.
class SparseMapFiles {
 public:
  /// @param output_directory  made if need be  @throws ConfigError if it cannot be written to
  SparseMapFiles(const NodeletHandles& node, const std::string& output_directory, TrackingRunner& runner,
                 TrackingPublisher& publisher);

  /// Takes up the map that this node had when it was killed, and localises only if that did; else the one in `folder`,
  /// if one is named, and localises only if that is asked for.  @throws Error, see localizeOnly()
  void begin(const std::string& folder, bool localize_only);
  /// Has mapping save what belongs to the map, too.  @return what was done  @throws Error, also where the file is
  /// another map that is larger: it is kept
  std::string saveMap() const;
  std::string loadMap() const;
  /// As TUM has it: stamp in s, position in m and quaternion of the optical frame in the map.
  std::string saveTrajectory() const;
  /// Has the runner localise only, or map again.  @return what is so now  @throws Error if there is no map for it
  std::string localizeOnly(bool on) const;
  /// To be called now and then.
  void keepForRecovery();
  /// The map was dropped: the node that takes the place of this one when it is killed gets none.
  void forget() { recovery_.forget(); }

 private:
  Map copyMap() const;
  void refuseToLose(const std::string& path, const Map& map) const;
  std::string load(const std::string& path) const;
  bool goOn() const;

  const std::string output_;
  TrackingRunner& runner_;
  TrackingPublisher& publisher_;
  Recovery recovery_;
  ros::Publisher map_saved_;
};

}  // namespace semantic_vslam
