// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <set>
#include <unordered_map>
#include <vector>

#include "core/features/frame_features.h"
#include "semantic_vslam/core/camera/camera_model.h"
#include "semantic_vslam/core/common/ids.h"
#include "semantic_vslam/core/common/stamp.h"
#include "semantic_vslam/core/geometry/se3.h"

namespace semantic_vslam {

/// A frame kept in the map. Its features never change; its pose and its matches to landmarks do, through Map only.
struct Keyframe {
  KeyframeId id;
  Stamp stamp;
  SE3 T_camera_world = SE3::Identity();
  std::shared_ptr<const CameraModel> camera;
  std::shared_ptr<const FrameFeatures> features;
  std::vector<LandmarkId> landmarks;  ///< per feature; invalid id = none
  KeyframeId parent;                  ///< in the spanning tree; invalid for the first of a tree
  std::vector<KeyframeId> loop_edges;
};

/// A static point of the world with the descriptor that finds it again.
struct Landmark {
  LandmarkId id;
  Eigen::Vector3d position_world = Eigen::Vector3d::Zero();       ///< metres
  Eigen::Vector3d mean_view_direction = Eigen::Vector3d::Zero();  ///< unit, from the cameras to the point
  double min_distance_m = 0.0, max_distance_m = 0.0;              ///< range in which the pyramid can find it again
  cv::Mat1b descriptor;                                           ///< 1 x 32, the medoid of its observations
  std::map<KeyframeId, int> observations;                         ///< keyframe -> index of the feature there
  KeyframeId reference_keyframe;
  KeyframeId created_in;  ///< newest keyframe when it was made; recent landmarks are on probation
  int visible_count = 1;  ///< frames in which it should have been seen
  int found_count = 1;    ///< frames in which it was
};

/// What an optimiser gives back: new values for some keyframes and landmarks, and matches found to be wrong.
struct MapSolution {
  std::unordered_map<KeyframeId, SE3> T_camera_world;
  std::unordered_map<LandmarkId, Eigen::Vector3d> position_world;
  std::vector<std::pair<KeyframeId, LandmarkId>> outlier_observations;
};

/// Sole owner of keyframes and landmarks, held by value; everybody else holds ids or copies. Keyframes hang in spanning
/// trees. Each tree has a frame of reference of its own: the one with the oldest keyframe is the world, another one was
/// begun at an unknown place and waits to be joined with it (see joinTrees()). Knows no thread: the
/// caller serialises access.
/// What a saved map is known by.
struct MapOrigin {
  std::uint32_t map_id = 0;        ///< MapSnapshot::map_id when it was saved; 0: it never was
  std::optional<SE3> T_map_world;  ///< where its world lay in the robot's map frame
};

class Map {
 public:
  // -- growing
  /// @param keyframe  all but id set; matches in `landmarks` are entered as observations. @return its id.
  KeyframeId addKeyframe(Keyframe keyframe);
  /// Makes a landmark seen by one feature of one keyframe, which must have none there yet.
  LandmarkId addLandmark(const Eigen::Vector3d& position_world, KeyframeId seen_by, int feature_index);
  /// Adds one observation; replaces nothing. @return false if either is gone or the feature already has a landmark.
  bool addObservation(KeyframeId keyframe, int feature_index, LandmarkId landmark);

  // -- shrinking
  void removeObservation(KeyframeId keyframe, LandmarkId landmark);
  void removeLandmark(LandmarkId landmark);
  /// Removes a keyframe, re-hangs its children in the spanning tree. The first keyframe of a tree stays.
  void removeKeyframe(KeyframeId keyframe);
  /// Removes a whole tree with all that only it sees. @return its keyframes
  std::vector<KeyframeId> removeTree(KeyframeId root);
  /// Moves all observations of `from` to `into` and removes `from`.
  void fuseLandmarks(LandmarkId from, LandmarkId into);
  void clear();

  // -- reading
  const std::map<KeyframeId, Keyframe>& keyframes() const { return keyframes_; }
  const std::unordered_map<LandmarkId, Landmark>& landmarks() const { return landmarks_; }
  const Keyframe* keyframe(KeyframeId id) const;  ///< nullptr if gone
  const Landmark* landmark(LandmarkId id) const;  ///< nullptr if gone
  /// Neighbours that share landmarks, most shared first. @param minimum_shared fewer shared landmarks do not count.
  std::vector<std::pair<KeyframeId, int>> covisible(KeyframeId id, int minimum_shared) const;
  std::vector<KeyframeId> children(KeyframeId id) const;
  /// First keyframe of the tree that a keyframe hangs in; invalid if it is gone.
  KeyframeId rootOf(KeyframeId id) const;
  /// rootOf() of every keyframe, at once.
  std::unordered_map<KeyframeId, KeyframeId> roots() const;
  /// Root of the oldest tree, whose poses are those in the world; invalid if there is no keyframe.
  KeyframeId worldRoot() const { return keyframes_.empty() ? KeyframeId() : keyframes_.begin()->first; }
  /// Whether the keyframe hangs in the tree of the oldest one, so that its pose is one in the world.
  bool isPlaced(KeyframeId id) const { return !keyframes_.empty() && rootOf(id) == worldRoot(); }
  /// Of a map that was loaded, or is going to be saved.
  const MapOrigin& origin() const { return origin_; }
  void setOrigin(const MapOrigin& origin) { origin_ = origin; }
  /// Grows by one with every change that an optimiser's copied problem could conflict with (loop, reset, load).
  std::uint64_t version() const { return version_; }

  // -- changing
  /// Takes an optimiser's result. Ids that are gone are passed over.
  /// @return false, with nothing changed, if the map has another version than the problem was copied from.
  bool apply(const MapSolution& solution, std::uint64_t version);
  void setPose(KeyframeId id, const SE3& T_camera_world);
  void setPosition(LandmarkId id, const Eigen::Vector3d& position_world);
  void addLoopEdge(KeyframeId a, KeyframeId b);
  /// Moves all keyframes of a tree and the landmarks they see.
  /// @param T_new_old  takes points of the tree's present frame of reference to the new one
  void moveTree(KeyframeId root, const SE3& T_new_old);
  /// Hangs a whole tree into another one: `member` becomes a child of `parent`, which must hang in another tree.
  void hangTree(KeyframeId member, KeyframeId parent);
  void countVisible(LandmarkId id);
  void countFound(LandmarkId id);
  /// Recomputes descriptor, view direction and distance range from the observations.
  void refreshLandmark(LandmarkId id);
  /// The same without the descriptor: after an optimiser moved the point or its cameras.
  void refreshGeometry(LandmarkId id);
  void bumpVersion() { ++version_; }

  // -- storing
  /// Ids that the next keyframe and the next landmark will get.
  std::uint64_t nextKeyframe() const { return next_keyframe_; }
  std::uint64_t nextLandmark() const { return next_landmark_; }
  /// Puts a stored map in the place of this one; ids stay what they were.
  /// @param keyframes  their `landmarks` are not read: they follow from the landmarks' observations
  /// @param landmarks  observations must name keyframes and features that exist, each feature at most once
  void restore(std::map<KeyframeId, Keyframe> keyframes, std::unordered_map<LandmarkId, Landmark> landmarks,
               std::uint64_t next_keyframe, std::uint64_t next_landmark);

 private:
  void forgetKeyframe(KeyframeId id);
  Keyframe* mutableKeyframe(KeyframeId id);
  Landmark* mutableLandmark(LandmarkId id);

  std::map<KeyframeId, Keyframe> keyframes_;
  std::unordered_map<LandmarkId, Landmark> landmarks_;
  std::unordered_map<KeyframeId, std::unordered_map<KeyframeId, int>> shared_;  ///< covisibility weights
  std::uint64_t next_keyframe_ = 0, next_landmark_ = 0, version_ = 0;
  MapOrigin origin_;
};

}  // namespace semantic_vslam
