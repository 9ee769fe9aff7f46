// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/dense/dense_mapper.h"
#include "eval/room_truth.h"
#include "eval/synthetic_room.h"
#include "semantic_vslam/core/camera/rgbd_frame.h"
#include "semantic_vslam/core/dense/dense_result.h"

namespace semantic_vslam {

/// Points by place, for the question whether one lies near.
class PointIndex {
 public:
  /// @param reach_m  the farthest that will be asked for
  PointIndex(const std::vector<LabelledPoint>& points, double reach_m);
  /// @param within_m  at most reach_m
  bool hasNear(const Eigen::Vector3d& point, double within_m) const;

 private:
  double reach_m_;
  std::unordered_map<std::uint64_t, std::vector<cv::Vec3f>> cells_;
};

/// A map beside the map of the same room without people, made of the same keyframes at the same poses. Both are taken
/// as 2 cm cubes.
struct RoomComparison {
  std::size_t points = 0, empty_points = 0;
  double left_over = 0.0;                       ///< share of the map's cubes farther than 5 cm from the empty room
  double found_again = 0.0;                     ///< share of the empty room's cubes with one of the map within 3 cm
  std::vector<LabelledPoint> left_over_points;  ///< of the map as given
};
RoomComparison compareWithEmptyRoom(const std::vector<LabelledPoint>& map, const std::vector<LabelledPoint>& empty);

/// Which of some points the frames of a map saw, past the people before them: the rest no map of these frames can have.
class SeenPastPeople {
 public:
  explicit SeenPastPeople(std::vector<LabelledPoint> points) : points_(std::move(points)), seen_(points_.size()) {}

  /// A point is seen where the depth is its own, but for 5 cm and the depth's noise, and no person is.
  /// @param people  true mask: 128 and more where people are, of the frame's size
  void add(const RgbdFrame& frame, const cv::Mat1b& people, const SE3& T_world_camera);
  std::vector<LabelledPoint> seen() const;

 private:
  std::vector<LabelledPoint> points_;
  std::vector<bool> seen_;
};

/// What of a rendered room its camera saw, gathered from exact depth.
class SeenRoom {
 public:
  explicit SeenRoom(RoomTruth truth) : truth_(std::move(truth)) {}

  /// Takes in one frame, every fourth pixel of it.
  void add(const SyntheticFrame& frame, const CameraModel& camera);

  const RoomTruth& truth() const { return truth_; }
  /// Whether a person or a carried thing was seen within 5 cm of a place at any time.
  bool anyoneNear(const Eigen::Vector3d& point) const;

  /// A thing with the surface that was seen of it, as 2 cm cubes.
  struct Thing {
    std::uint8_t label = 0;
    std::vector<Eigen::Vector3d> surface;
    Eigen::Vector3d centroid_m = Eigen::Vector3d::Zero();
  };
  /// Things of other classes than background of which at least `least` cubes were seen.
  std::vector<Thing> things(std::size_t least) const;

 private:
  RoomTruth truth_;
  std::unordered_map<std::uint64_t, int> people_;  // 5 cm cubes; value: times seen
  std::map<std::pair<int, std::uint8_t>, std::unordered_map<std::uint64_t, Eigen::Vector3d>> surface_;
};

/// How a map's cloud and voxels fit the room. Shares are 0..1.
struct SurfaceScore {
  std::size_t points = 0, voxels = 0;
  double points_within_2cm = 0.0;  ///< share of the cloud's points this near to a true surface
  double mean_error_m = 0.0;       ///< of the cloud's points, up to RoomTruth::kReachM each
  double voxels_beyond_5cm = 0.0;  ///< share of occupied voxels this far from anything real
  double voxels_of_people = 0.0;   ///< of all occupied voxels: those far from anything real where someone was
  double labels_right = 0.0;       ///< share of the voxels near a true surface that bear its label
  double surface_found = 0.0;      ///< share of the seen surface's cubes with a point of the map within 3 cm
};
/// @param T_truth_world  from the map's world into the room's
SurfaceScore scoreSurface(const DenseMapper& map, const SE3& T_truth_world, const SeenRoom& room);

/// How a navigation grid fits the room. Counts of cells.
struct GridScore {
  int free = 0, occupied = 0;
  int free_on_obstacle = 0;  ///< free, though something stands all over the cell, 2 cm of its edge left out
  int occupied_on_free = 0;  ///< occupied, though nothing stands in the cell or one beside it
  int passable_known = 0;    ///< free and truly so
  int passable = 0;          ///< truly free, within the room's walls
};
/// @param grid  in the room's frame  @param low_m, high_m  the band above the floor that was asked for
GridScore scoreGrid(const OccupancyGrid& grid, double low_m, double high_m, const RoomTruth& truth);

/// Objects of the map against the things of the room, for one class.
struct ObjectScore {
  int things = 0;                        ///< of which enough was seen
  int listed_once = 0;                   ///< exactly one object lies on it
  int pieces = 0;                        ///< objects on things of this class beyond the first of each
  int missing = 0;                       ///< no object lies on it
  int on_nothing = 0;                    ///< objects of the class that lie on no thing of it
  std::vector<double> centroid_error_m;  ///< of each thing that is listed once
};
/// An object lies on the thing of its class whose seen surface is nearest to its centroid, within half a metre.
/// @param objects  in the room's frame
std::map<std::uint8_t, ObjectScore> scoreObjects(const std::vector<MapObject>& objects, const SeenRoom& room);

}  // namespace semantic_vslam
