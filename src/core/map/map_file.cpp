// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/map/map_file.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <set>
#include <unordered_set>
#include <utility>
#include <vector>

#include "core/common/atomic_file.h"
#include "core/common/binary_file.h"
#include "core/geometry/binary_pose.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

constexpr BinaryFormat kFormat = {"SVSLAMAP", 2, "map file"};
constexpr std::size_t kDescriptorBytes = 32;

using Cameras = std::vector<std::shared_ptr<const CameraModel>>;

bool sameIntrinsics(const CameraIntrinsics& a, const CameraIntrinsics& b) {
  return a.width == b.width && a.height == b.height && a.fx == b.fx && a.fy == b.fy && a.cx == b.cx && a.cy == b.cy &&
         a.distortion == b.distortion;
}

/// Distinct cameras in the order of the keyframes, and which one each keyframe has.
Cameras collectCameras(const Map& map, std::vector<std::uint32_t>& camera_of_keyframe) {
  Cameras cameras;
  for (const auto& [id, keyframe] : map.keyframes()) {
    const auto& intrinsics = keyframe.camera->intrinsics();
    const auto known = std::find_if(cameras.begin(), cameras.end(), [&](const auto& camera) {
      return sameIntrinsics(camera->intrinsics(), intrinsics);
    });
    camera_of_keyframe.push_back(static_cast<std::uint32_t>(known - cameras.begin()));
    if (known == cameras.end()) cameras.push_back(keyframe.camera);
  }
  return cameras;
}

void writeCamera(BinaryWriter& out, const CameraIntrinsics& k) {
  out.put<std::int32_t>(k.width);
  out.put<std::int32_t>(k.height);
  for (const double value : {k.fx, k.fy, k.cx, k.cy}) out.put(value);
  for (const double value : k.distortion) out.put(value);
}

std::shared_ptr<const CameraModel> readCamera(BinaryReader& in) {
  CameraIntrinsics k;
  k.width = in.get<std::int32_t>();
  k.height = in.get<std::int32_t>();
  for (double* value : {&k.fx, &k.fy, &k.cx, &k.cy}) *value = in.get<double>();
  for (double& value : k.distortion) value = in.get<double>();
  try {
    return std::make_shared<CameraModel>(k);
  } catch (const ConfigError&) {
    in.require(false);
    return nullptr;
  }
}

void writeFeatures(BinaryWriter& out, const FrameFeatures& features) {
  out.putCount(features.size());
  for (const Feature& f : features.features) {
    out.putMatrix(f.raw_px);
    out.putMatrix(f.undistorted_px);
    out.put(f.depth_m);
    out.put(f.angle_rad);
    out.put(static_cast<std::uint8_t>(f.octave));
    out.put(f.static_weight);
  }
  for (int i = 0; i < static_cast<int>(features.size()); ++i)
    out.putBytes(features.descriptors.ptr(i), kDescriptorBytes);
}

std::shared_ptr<const FrameFeatures> readFeatures(BinaryReader& in) {
  auto features = std::make_shared<FrameFeatures>();
  features->features.resize(in.getCount(7 * sizeof(float) + 1 + kDescriptorBytes));
  for (Feature& f : features->features) {
    in.getMatrix(f.raw_px);
    in.getMatrix(f.undistorted_px);
    f.depth_m = in.get<float>();
    f.angle_rad = in.get<float>();
    f.octave = in.get<std::uint8_t>();
    f.static_weight = in.get<float>();
    in.require(f.octave < kPyramidLevels && f.raw_px.allFinite() && f.undistorted_px.allFinite() &&
               std::isfinite(f.depth_m) && std::isfinite(f.angle_rad) && f.static_weight >= 0.0F &&
               f.static_weight <= 1.0F);
  }
  features->descriptors.create(static_cast<int>(features->size()), static_cast<int>(kDescriptorBytes));
  for (int i = 0; i < features->descriptors.rows; ++i) in.getBytes(features->descriptors.ptr(i), kDescriptorBytes);
  return features;
}

void writeKeyframe(BinaryWriter& out, const Keyframe& keyframe, std::uint32_t camera) {
  out.putId(keyframe.id);
  out.put(keyframe.stamp.ns);
  putPose(out, keyframe.T_camera_world);
  out.put(camera);
  out.putId(keyframe.parent);
  out.putCount(keyframe.loop_edges.size());
  for (const KeyframeId edge : keyframe.loop_edges) out.putId(edge);
  writeFeatures(out, *keyframe.features);
}

Keyframe readKeyframe(BinaryReader& in, const Cameras& cameras) {
  Keyframe keyframe;
  keyframe.id = in.getId<KeyframeId>();
  keyframe.stamp.ns = in.get<std::int64_t>();
  keyframe.T_camera_world = getPose(in);
  const auto camera = in.get<std::uint32_t>();
  in.require(camera < cameras.size());
  keyframe.camera = cameras[camera];
  keyframe.parent = in.getId<KeyframeId>();
  keyframe.loop_edges.resize(in.getCount(sizeof(std::uint64_t)));
  for (KeyframeId& edge : keyframe.loop_edges) edge = in.getId<KeyframeId>();
  keyframe.features = readFeatures(in);
  return keyframe;
}

void writeLandmark(BinaryWriter& out, const Landmark& landmark) {
  out.putId(landmark.id);
  out.putMatrix(landmark.position_world);
  out.putMatrix(landmark.mean_view_direction);
  out.put(landmark.min_distance_m);
  out.put(landmark.max_distance_m);
  out.putBytes(landmark.descriptor.ptr(), kDescriptorBytes);
  out.putId(landmark.reference_keyframe);
  out.putId(landmark.created_in);
  out.put<std::int32_t>(landmark.visible_count);
  out.put<std::int32_t>(landmark.found_count);
  out.putCount(landmark.observations.size());
  for (const auto& [keyframe, feature] : landmark.observations) {
    out.putId(keyframe);
    out.put<std::int32_t>(feature);
  }
}

Landmark readLandmark(BinaryReader& in) {
  Landmark landmark;
  landmark.id = in.getId<LandmarkId>();
  in.getMatrix(landmark.position_world);
  in.getMatrix(landmark.mean_view_direction);
  landmark.min_distance_m = in.get<double>();
  landmark.max_distance_m = in.get<double>();
  landmark.descriptor.create(1, static_cast<int>(kDescriptorBytes));
  in.getBytes(landmark.descriptor.ptr(), kDescriptorBytes);
  landmark.reference_keyframe = in.getId<KeyframeId>();
  landmark.created_in = in.getId<KeyframeId>();
  landmark.visible_count = in.get<std::int32_t>();
  landmark.found_count = in.get<std::int32_t>();
  in.require(isPosition(landmark.position_world) && landmark.mean_view_direction.allFinite() &&
             landmark.min_distance_m >= 0.0 && landmark.max_distance_m >= landmark.min_distance_m &&
             std::isfinite(landmark.max_distance_m) && landmark.visible_count >= 0 && landmark.found_count >= 0);
  const std::size_t observations = in.getCount(sizeof(std::uint64_t) + sizeof(std::int32_t));
  for (std::size_t i = 0; i < observations; ++i) {
    const auto keyframe = in.getId<KeyframeId>();
    in.require(landmark.observations.emplace(keyframe, in.get<std::int32_t>()).second);
  }
  return landmark;
}

/// Checks what Map::restore takes for granted.
void checkLinks(const BinaryReader& in, const std::map<KeyframeId, Keyframe>& keyframes,
                const std::unordered_map<LandmarkId, Landmark>& landmarks) {
  std::unordered_set<KeyframeId> rooted;  // whose parents are known to lead to a root
  for (const auto& [id, keyframe] : keyframes) {
    std::unordered_set<KeyframeId> way;
    for (KeyframeId at = id; at.valid() && rooted.count(at) == 0; at = keyframes.at(at).parent) {
      in.require(keyframes.count(at) > 0 && way.insert(at).second);
    }
    rooted.insert(way.begin(), way.end());
    for (const KeyframeId edge : keyframe.loop_edges) in.require(keyframes.count(edge) > 0);
  }
  std::set<std::pair<KeyframeId, int>> taken;
  for (const auto& [id, landmark] : landmarks) {
    in.require(landmark.observations.count(landmark.reference_keyframe) > 0);
    for (const auto& [keyframe_id, feature] : landmark.observations) {
      const auto keyframe = keyframes.find(keyframe_id);
      in.require(keyframe != keyframes.end() && feature >= 0 &&
                 feature < static_cast<int>(keyframe->second.features->size()) &&
                 taken.emplace(keyframe_id, feature).second);
    }
  }
}

std::vector<LandmarkId> sortedLandmarks(const Map& map) {
  std::vector<LandmarkId> ids;
  for (const auto& [id, landmark] : map.landmarks()) {
    ids.push_back(id);
  }
  std::sort(ids.begin(), ids.end());
  return ids;
}

}  // namespace

std::string serializeMap(const Map& map) {
  BinaryWriter payload;
  payload.put(map.origin().map_id);
  payload.put<std::uint8_t>(map.origin().T_map_world ? 1 : 0);
  putPose(payload, map.origin().T_map_world.value_or(SE3::Identity()));
  payload.put(map.nextKeyframe());
  payload.put(map.nextLandmark());
  std::vector<std::uint32_t> camera_of_keyframe;
  const Cameras cameras = collectCameras(map, camera_of_keyframe);
  payload.putCount(cameras.size());
  for (const auto& camera : cameras) writeCamera(payload, camera->intrinsics());
  payload.putCount(map.keyframes().size());
  std::size_t k = 0;
  for (const auto& [id, keyframe] : map.keyframes()) {
    writeKeyframe(payload, keyframe, camera_of_keyframe[k++]);
  }
  payload.putCount(map.landmarks().size());
  for (const LandmarkId id : sortedLandmarks(map)) writeLandmark(payload, *map.landmark(id));

  return payload.file(kFormat);
}

void parseMap(const std::string& content, const std::string& name, Map& map) {
  BinaryReader in(content, kFormat, name);
  MapOrigin origin;
  origin.map_id = in.get<std::uint32_t>();
  const bool placed = in.get<std::uint8_t>() != 0;
  const SE3 T_map_world = getPose(in);
  if (placed) origin.T_map_world = T_map_world;
  const auto next_keyframe = in.get<std::uint64_t>();
  const auto next_landmark = in.get<std::uint64_t>();
  // New ones are numbered from these on: they must be far from their end, and the last one means "none".
  constexpr std::uint64_t kMostIds = std::uint64_t{1} << 48;
  in.require(next_keyframe < kMostIds && next_landmark < kMostIds);
  constexpr std::size_t kCameraBytes = 2 * sizeof(std::int32_t) + 9 * sizeof(double), kMostCameras = 16;
  Cameras cameras(in.getCount(kCameraBytes));
  in.require(cameras.size() <= kMostCameras);  // each takes memory for a table of its pixels
  for (auto& camera : cameras) camera = readCamera(in);
  std::map<KeyframeId, Keyframe> keyframes;
  for (std::size_t i = in.getCount(1); i > 0; --i) {
    Keyframe keyframe = readKeyframe(in, cameras);
    const KeyframeId id = keyframe.id;
    in.require(id.value() < next_keyframe && keyframes.emplace(id, std::move(keyframe)).second);
  }
  std::unordered_map<LandmarkId, Landmark> landmarks;
  for (std::size_t i = in.getCount(1); i > 0; --i) {
    Landmark landmark = readLandmark(in);
    const LandmarkId id = landmark.id;
    in.require(id.value() < next_landmark && landmarks.emplace(id, std::move(landmark)).second);
  }
  in.require(in.atEnd());
  checkLinks(in, keyframes, landmarks);
  map.restore(std::move(keyframes), std::move(landmarks), next_keyframe, next_landmark);
  map.setOrigin(origin);
}

void saveMap(const std::string& path, const Map& map) { writeTextAtomically(path, serializeMap(map)); }

void loadMap(const std::string& path, Map& map) { parseMap(readBinaryFile(kFormat, path), path, map); }

void indexKeyframes(const Map& map, PlaceIndex& index) {
  for (const auto& [id, keyframe] : map.keyframes()) index.add(id, *keyframe.features);
}

}  // namespace semantic_vslam
