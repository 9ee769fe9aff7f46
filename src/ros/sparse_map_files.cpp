// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/sparse_map_files.h"

#include <ros/console.h>
#include <std_msgs/UInt32.h>
#include <unistd.h>

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "core/io/trajectory.h"
#include "core/map/map_file.h"
#include "core/pipeline/sparse_slam.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {

constexpr const char* kLocalizationOnly = "localization_only";
constexpr const char *kMapFile = "/map.slam", *kTrajectoryFile = "/trajectory.txt";

SparseMapFiles::SparseMapFiles(const NodeletHandles& node, const std::string& output_directory, TrackingRunner& runner,
                               TrackingPublisher& publisher)
    : output_(outputFolder(output_directory)),
      runner_(runner),
      publisher_(publisher),
      recovery_(node.private_nh, "map.slam"),
      map_saved_(node.nh.advertise<std_msgs::UInt32>("tracking/map_saved", 1)) {}

void SparseMapFiles::begin(const std::string& folder, bool localize_only) {
  if (goOn()) return;
  recovery_.leaveWord(kLocalizationOnly, false);
  if (!folder.empty()) ROS_INFO("%s", load(expandHome(folder) + kMapFile).c_str());
  if (localize_only) ROS_INFO("%s", localizeOnly(true).c_str());
}

bool SparseMapFiles::goOn() const {
  const std::optional<std::string> left = recovery_.left();
  if (!left) return false;
  try {
    ROS_INFO("going on after a restart: %s", load(*left).c_str());
    if (recovery_.hasWord(kLocalizationOnly)) ROS_INFO("%s", localizeOnly(true).c_str());
  } catch (const FileError& error) {
    ROS_ERROR("the map from before the restart is lost: %s", error.what());
    return false;
  }
  return true;
}

/// A slow disk must not hold up tracking: it is the copy that is written.
Map SparseMapFiles::copyMap() const {
  Map map;
  runner_.read([&](const TrackingStage& stage) { map = stage.copyMap(); });
  map.setOrigin({map.origin().map_id, publisher_.anchor()});
  return map;
}

/// A larger map may be the work of an hour, and is not written over by one that was begun since. Later states of the
/// same map are, also where upkeep has made it smaller.
void SparseMapFiles::refuseToLose(const std::string& path, const Map& map) const {
  if (map.keyframes().empty() || access(path.c_str(), F_OK) != 0) return;
  Map there;
  try {
    semantic_vslam::loadMap(path, there);
  } catch (const FileError&) {
    return;  // no map: nothing is lost
  }
  const std::uint32_t id = there.origin().map_id;
  std::uint32_t loaded = 0;
  runner_.read([&](const TrackingStage& stage) { loaded = stage.loadedFrom(); });
  if (id == map.origin().map_id || id == loaded || there.keyframes().size() <= map.keyframes().size()) return;
  throw Error(path + " is another map, of " + std::to_string(there.keyframes().size()) +
              " keyframes, and is kept; this one has " + std::to_string(map.keyframes().size()) +
              ". Move that file and map.dense away to save this one, or load_map to go on in it");
}

std::string SparseMapFiles::saveMap() const {
  const Map map = copyMap();
  refuseToLose(output_ + kMapFile, map);
  const std::size_t keyframes = SparseSlam::saveMap(output_ + kMapFile, map);
  std_msgs::UInt32 saved;
  saved.data = map.origin().map_id;
  map_saved_.publish(saved);
  return "map of " + std::to_string(keyframes) + " keyframes saved in " + output_ + kMapFile;
}

std::string SparseMapFiles::loadMap() const { return load(output_ + kMapFile); }

std::string SparseMapFiles::load(const std::string& path) const {
  const std::shared_ptr<SavedMap> saved = runner_.stage().readMap(path);  // long: tracking goes on
  const std::size_t keyframes = saved->map.keyframes().size();
  runner_.change([&](TrackingStage& stage) {
    publisher_.anchorNextMap(saved->map.origin().T_map_world);
    stage.loadMap(*saved);
  });
  return "map of " + std::to_string(keyframes) + " keyframes loaded from " + path;
}

std::string SparseMapFiles::localizeOnly(bool on) const {
  std::size_t keyframes = 0;
  runner_.read([&](const TrackingStage& stage) { keyframes = stage.slam().keyframeCount(); });
  if (on && keyframes == 0) {
    throw Error("there is no map to localise in; load one (load_map, or map:=DIR at the start), or map first");
  }
  runner_.setLocalizationOnly(on);
  recovery_.leaveWord(kLocalizationOnly, on);
  const std::string map = "the map of " + std::to_string(keyframes) + " keyframes";
  return on ? "localisation only: " + map + " is read and stays as it is" : "mapping: " + map + " grows and changes";
}

std::string SparseMapFiles::saveTrajectory() const {
  std::vector<TimedPose> poses;
  runner_.read([&](const TrackingStage& stage) { poses = stage.slam().trajectory(); });
  poses = publisher_.inMap(std::move(poses));
  if (poses.empty()) throw Error("no frame has a pose yet; " + output_ + kTrajectoryFile + " is not touched");
  writeTumTrajectory(output_ + kTrajectoryFile, poses);
  return std::to_string(poses.size()) + " poses saved in " + output_ + kTrajectoryFile;
}

void SparseMapFiles::keepForRecovery() {
  std::size_t version = 0, keyframes = 0;
  runner_.read([&](const TrackingStage& stage) {
    version = stage.slam().posesVersion();
    keyframes = stage.slam().keyframeCount();
  });
  if (keyframes == 0) return recovery_.forgetOwn();
  recovery_.keep(version, [this](const std::string& path) {
    const Map map = copyMap();
    if (!map.keyframes().empty()) SparseSlam::saveMap(path, map);  // else it was dropped meanwhile
  });
}

}  // namespace semantic_vslam
