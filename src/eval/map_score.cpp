// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "eval/map_score.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/dense/keyframe_cloud.h"
#include "core/dense/voxel_key.h"

namespace semantic_vslam {
namespace {

using Eigen::Vector3d;

constexpr double kCubeM = 0.02;  // both clouds are compared in
constexpr double kLeftOverM = 0.05, kFoundM = 0.03;
constexpr double kPeopleM = 0.05;        // cubes that people's places are kept in
constexpr std::size_t kLeastSeen = 100;  // 2 cm cubes of a thing, 400 cm^2: less nobody can tell

double share(std::size_t part, std::size_t whole) {
  return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace

PointIndex::PointIndex(const std::vector<LabelledPoint>& points, double reach_m) : reach_m_(reach_m) {
  for (const LabelledPoint& point : points) {
    cells_[voxelKey(voxelIndexAt(point.position(), reach_m_))].push_back(point.xyz_m);
  }
}

bool PointIndex::hasNear(const Vector3d& point, double within_m) const {
  const Eigen::Vector3i middle = voxelIndexAt(point, reach_m_);
  for (int i = 0; i < 27; ++i) {
    const auto found = cells_.find(voxelKey(middle + Eigen::Vector3i(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1)));
    if (found == cells_.end()) continue;
    for (const cv::Vec3f& p : found->second) {
      if ((Vector3d(p[0], p[1], p[2]) - point).squaredNorm() <= within_m * within_m) return true;
    }
  }
  return false;
}

RoomComparison compareWithEmptyRoom(const std::vector<LabelledPoint>& map, const std::vector<LabelledPoint>& empty) {
  const std::vector<LabelledPoint> cubes = voxelFilter(map, kCubeM), empty_cubes = voxelFilter(empty, kCubeM);
  const PointIndex index(cubes, kLeftOverM), empty_index(empty_cubes, kLeftOverM);
  RoomComparison result;
  result.points = cubes.size();
  result.empty_points = empty_cubes.size();
  const auto leftOver = [&](const LabelledPoint& p) { return !empty_index.hasNear(p.position(), kLeftOverM); };
  const auto left_over = std::count_if(cubes.begin(), cubes.end(), leftOver);
  std::copy_if(map.begin(), map.end(), std::back_inserter(result.left_over_points), leftOver);
  const auto found = std::count_if(empty_cubes.begin(), empty_cubes.end(),
                                   [&](const LabelledPoint& p) { return index.hasNear(p.position(), kFoundM); });
  result.left_over = share(static_cast<std::size_t>(left_over), cubes.size());
  result.found_again = share(static_cast<std::size_t>(found), empty_cubes.size());
  return result;
}

void SeenPastPeople::add(const RgbdFrame& frame, const cv::Mat1b& people, const SE3& T_world_camera) {
  const double noise_m_per_m2 = 3.0 * MapDepthNoise().surfaces_m;
  const SE3 T_camera_world = T_world_camera.inverse();
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Vector3d p = T_camera_world * points_[i].position();
    if (seen_[i] || p.z() <= 0.0) continue;
    const Eigen::Vector2d pixel = frame.camera->projectRaw(p);
    const cv::Point at(cvRound(pixel.x()), cvRound(pixel.y()));
    if (!cv::Rect({0, 0}, frame.depth_m.size()).contains(at) || people(at) >= 128) continue;
    seen_[i] = std::abs(frame.depth_m(at) - p.z()) < kLeftOverM + noise_m_per_m2 * p.z() * p.z();
  }
}

std::vector<LabelledPoint> SeenPastPeople::seen() const {
  std::vector<LabelledPoint> seen;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (seen_[i]) seen.push_back(points_[i]);
  }
  return seen;
}

void SeenRoom::add(const SyntheticFrame& frame, const CameraModel& camera) {
  constexpr int kStridePx = 4;
  constexpr float kFarthestM = 4.0F;  // what the map takes in
  for (int v = 0; v < frame.true_depth_m.rows; v += kStridePx) {
    for (int u = 0; u < frame.true_depth_m.cols; u += kStridePx) {
      const float z_m = frame.true_depth_m(v, u);
      if (z_m <= 0.0F || z_m > kFarthestM) continue;
      const cv::Vec2f& ray = camera.rays()(v, u);
      const Vector3d p = frame.T_world_camera * Vector3d(ray[0] * z_m, ray[1] * z_m, z_m);
      if (frame.person_mask(v, u) != 0 || frame.moving_mask(v, u) != 0) {
        ++people_[voxelKey(voxelIndexAt(p, kPeopleM))];
        continue;
      }
      const RoomTruth::Nearest nearest = truth_.nearest(p);
      // A thing that was moved later stands nowhere in the truth.
      if (nearest.distance_m < 0.01) {
        surface_[{nearest.thing, nearest.label}].emplace(voxelKey(voxelIndexAt(p, kCubeM)), p);
      }
    }
  }
}

bool SeenRoom::anyoneNear(const Vector3d& point) const {
  const Eigen::Vector3i middle = voxelIndexAt(point, kPeopleM);
  for (int i = 0; i < 27; ++i) {
    if (people_.count(voxelKey(middle + Eigen::Vector3i(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1))) > 0) return true;
  }
  return false;
}

std::vector<SeenRoom::Thing> SeenRoom::things(std::size_t least) const {
  std::vector<Thing> things;
  for (const auto& [key, cubes] : surface_) {
    if (key.second == 0 && least > 0) continue;
    if (cubes.size() < least) continue;
    Thing thing;
    thing.label = key.second;
    for (const auto& [cube, p] : cubes) thing.surface.push_back(p);
    for (const Vector3d& p : thing.surface) thing.centroid_m += p / static_cast<double>(thing.surface.size());
    things.push_back(std::move(thing));
  }
  return things;
}

SurfaceScore scoreSurface(const DenseMapper& map, const SE3& T_truth_world, const SeenRoom& room) {
  SurfaceScore score;
  std::vector<LabelledPoint> cloud = map.cloud();
  std::size_t near = 0;
  for (LabelledPoint& point : cloud) {
    const Vector3d p = T_truth_world * point.position();
    point.xyz_m = cv::Vec3f(static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z()));
    const double distance_m = room.truth().nearest(p).distance_m;
    if (distance_m <= 0.02) ++near;
    score.mean_error_m += distance_m / static_cast<double>(cloud.size());
  }
  std::size_t beyond = 0, people = 0, right = 0;
  map.voxelMap().forEachKnown([&](const Voxel& voxel) {
    if (voxel.state != Occupancy::kOccupied) return;
    ++score.voxels;
    const Vector3d p = T_truth_world * map.voxelMap().centre(voxel.index);
    const RoomTruth::Nearest nearest = room.truth().nearest(p);
    if (nearest.distance_m > kLeftOverM) {
      ++beyond;
      if (room.anyoneNear(p)) ++people;
    } else if (nearest.label == voxel.label) {
      ++right;
    }
  });
  const PointIndex index(cloud, kFoundM);
  std::size_t seen = 0, found = 0;
  for (const SeenRoom::Thing& thing : room.things(0)) {
    for (const Vector3d& p : thing.surface) {
      ++seen;
      if (index.hasNear(p, kFoundM)) ++found;
    }
  }
  score.points = cloud.size();
  score.points_within_2cm = share(near, cloud.size());
  score.voxels_beyond_5cm = share(beyond, score.voxels);
  score.voxels_of_people = share(people, score.voxels);
  score.labels_right = share(right, score.voxels - beyond);
  score.surface_found = share(found, seen);
  return score;
}

GridScore scoreGrid(const OccupancyGrid& grid, double low_m, double high_m, const RoomTruth& truth) {
  GridScore score;
  constexpr double kEdgeM = 0.02;  // the pose's error
  const double half_m = grid.resolution_m / 2.0;
  const auto over = [&](double x_m, double y_m) { return truth.obstacleOver(x_m, y_m, low_m, high_m); };
  for (int y = 0; y < grid.height; ++y) {
    for (int x = 0; x < grid.width; ++x) {
      const std::int8_t cell = grid.at(x, y);
      const double x_m = grid.origin_x_m + x * grid.resolution_m + half_m;
      const double y_m = grid.origin_y_m + y * grid.resolution_m + half_m;
      int covered = 0;
      for (const double dx : {-kEdgeM, 0.0, kEdgeM}) {
        for (const double dy : {-kEdgeM, 0.0, kEdgeM}) covered += over(x_m + dx, y_m + dy) ? 1 : 0;
      }
      // A floor below: outside of the room there is nothing to drive on.
      const bool passable = covered == 0 && truth.obstacleOver(x_m, y_m, -0.05, 0.0);
      if (passable) ++score.passable;
      if (cell == OccupancyGrid::kFree) {
        ++score.free;
        if (covered == 9) ++score.free_on_obstacle;
        if (passable) ++score.passable_known;
      } else if (cell == OccupancyGrid::kOccupied) {
        ++score.occupied;
        bool anything = covered > 0;
        for (const double dx : {-1.5, -1.0, 0.0, 1.0, 1.5}) {
          for (const double dy : {-1.5, -1.0, 0.0, 1.0, 1.5}) {
            anything = anything || over(x_m + dx * grid.resolution_m, y_m + dy * grid.resolution_m);
          }
        }
        if (!anything) ++score.occupied_on_free;
      }
    }
  }
  return score;
}

std::map<std::uint8_t, ObjectScore> scoreObjects(const std::vector<MapObject>& objects, const SeenRoom& room) {
  constexpr double kOnThingM = 0.5;
  // Small things may be listed, but need not be.
  const std::vector<SeenRoom::Thing> things = room.things(5);
  std::vector<std::vector<const MapObject*>> on_thing(things.size());
  std::map<std::uint8_t, ObjectScore> scores;
  for (const MapObject& object : objects) {
    double nearest_m = kOnThingM;
    std::size_t best = things.size();
    for (std::size_t i = 0; i < things.size(); ++i) {
      if (things[i].label != object.label) continue;
      for (const Vector3d& p : things[i].surface) {
        const double distance_m = (p - object.centroid_m).norm();
        if (distance_m < nearest_m) {
          nearest_m = distance_m;
          best = i;
        }
      }
    }
    if (best == things.size()) {
      ++scores[object.label].on_nothing;
    } else {
      on_thing[best].push_back(&object);
    }
  }
  for (std::size_t i = 0; i < things.size(); ++i) {
    if (things[i].surface.size() < kLeastSeen) continue;
    ObjectScore& score = scores[things[i].label];
    ++score.things;
    if (on_thing[i].empty()) ++score.missing;
    if (on_thing[i].size() == 1) {
      ++score.listed_once;
      score.centroid_error_m.push_back((on_thing[i][0]->centroid_m - things[i].centroid_m).norm());
    }
    score.pieces += std::max(0, static_cast<int>(on_thing[i].size()) - 1);
  }
  return scores;
}

}  // namespace semantic_vslam
