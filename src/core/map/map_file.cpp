// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/map/map_file.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <memory>
#include <set>
#include <type_traits>
#include <unordered_set>
#include <utility>
#include <vector>

#include "core/common/atomic_file.h"
#include "core/common/input_file.h"
#include "semantic_vslam/core/common/error.h"

#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "map files are little-endian: byte swaps are missing here"
#endif

namespace semantic_vslam {
namespace {

constexpr char kMagic[8] = {'S', 'V', 'S', 'L', 'A', 'M', 'A', 'P'};
constexpr std::uint32_t kFormatVersion = 1;
constexpr std::size_t kHeaderBytes =
    sizeof(kMagic) + sizeof(std::uint32_t) + sizeof(std::uint64_t) + sizeof(std::uint32_t);
constexpr std::size_t kDescriptorBytes = 32;

/// CRC-32 as in zip and PNG (polynomial 0xEDB88320, reflected).
std::uint32_t crc32(const char* data, std::size_t size) {
  static const auto table = [] {
    std::array<std::uint32_t, 256> t{};
    for (std::uint32_t i = 0; i < t.size(); ++i) {
      std::uint32_t c = i;
      for (int bit = 0; bit < 8; ++bit) c = (c & 1U) != 0 ? 0xEDB88320U ^ (c >> 1) : c >> 1;
      t[i] = c;
    }
    return t;
  }();
  std::uint32_t crc = 0xFFFFFFFFU;
  for (std::size_t i = 0; i < size; ++i) crc = table[(crc ^ static_cast<std::uint8_t>(data[i])) & 0xFFU] ^ (crc >> 8);
  return crc ^ 0xFFFFFFFFU;
}

class Writer {
 public:
  template <class T>
  void put(const T& value) {
    static_assert(std::is_arithmetic<T>::value, "write members one by one: structs have padding");
    putBytes(&value, sizeof(value));
  }
  void putBytes(const void* data, std::size_t size) { bytes_.append(static_cast<const char*>(data), size); }
  void putCount(std::size_t count) { put(static_cast<std::uint64_t>(count)); }
  template <class Tag>
  void putId(Id<Tag> id) {
    put(id.value());
  }
  template <class Derived>
  void putMatrix(const Eigen::MatrixBase<Derived>& m) {
    for (Eigen::Index r = 0; r < m.rows(); ++r) {
      for (Eigen::Index c = 0; c < m.cols(); ++c) put(m(r, c));
    }
  }
  std::string& bytes() { return bytes_; }

 private:
  std::string bytes_;
};

/// Reads what Writer wrote; every step past the end or out of range is a FileError.
class Reader {
 public:
  Reader(const std::string& bytes, std::size_t offset, std::string name)
      : bytes_(bytes), at_(offset), name_(std::move(name)) {}

  template <class T>
  T get() {
    T value;
    getBytes(&value, sizeof(value));
    return value;
  }
  void getBytes(void* data, std::size_t size) {
    require(size <= bytes_.size() - at_);
    std::memcpy(data, bytes_.data() + at_, size);
    at_ += size;
  }
  /// A number of items of at least item_bytes each: more than the file can hold is refused before memory is taken.
  std::size_t getCount(std::size_t item_bytes) {
    const auto count = get<std::uint64_t>();
    require(count <= (bytes_.size() - at_) / item_bytes);
    return static_cast<std::size_t>(count);
  }
  template <class SomeId>
  SomeId getId() {
    return SomeId(get<std::uint64_t>());
  }
  template <class Derived>
  void getMatrix(Eigen::MatrixBase<Derived>& m) {
    for (Eigen::Index r = 0; r < m.rows(); ++r) {
      for (Eigen::Index c = 0; c < m.cols(); ++c) m(r, c) = get<typename Derived::Scalar>();
    }
  }
  bool atEnd() const { return at_ == bytes_.size(); }
  void require(bool consistent) const {
    if (!consistent)
      throw FileError("map file '" + name_ + "' is damaged: its content contradicts itself; save it anew");
  }

 private:
  const std::string& bytes_;
  std::size_t at_;
  std::string name_;
};

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

/// Also refuses NaN.
bool isPosition(const Eigen::Vector3d& p_m) {
  constexpr double kFarthestM = 1e7;  // ten times what initial_pose takes
  return p_m.cwiseAbs().maxCoeff() <= kFarthestM && p_m.allFinite();
}

void writeCamera(Writer& out, const CameraIntrinsics& k) {
  out.put<std::int32_t>(k.width);
  out.put<std::int32_t>(k.height);
  for (const double value : {k.fx, k.fy, k.cx, k.cy}) out.put(value);
  for (const double value : k.distortion) out.put(value);
}

std::shared_ptr<const CameraModel> readCamera(Reader& in) {
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

void writeFeatures(Writer& out, const FrameFeatures& features) {
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

std::shared_ptr<const FrameFeatures> readFeatures(Reader& in) {
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

void writeKeyframe(Writer& out, const Keyframe& keyframe, std::uint32_t camera) {
  out.putId(keyframe.id);
  out.put(keyframe.stamp.ns);
  out.putMatrix(keyframe.T_camera_world.linear());
  out.putMatrix(keyframe.T_camera_world.translation());
  out.put(camera);
  out.putId(keyframe.parent);
  out.putCount(keyframe.loop_edges.size());
  for (const KeyframeId edge : keyframe.loop_edges) out.putId(edge);
  writeFeatures(out, *keyframe.features);
}

Keyframe readKeyframe(Reader& in, const Cameras& cameras) {
  Keyframe keyframe;
  keyframe.id = in.getId<KeyframeId>();
  keyframe.stamp.ns = in.get<std::int64_t>();
  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation;
  in.getMatrix(rotation);
  in.getMatrix(translation);
  const double skewed = (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  in.require(skewed < 1e-3 && rotation.determinant() > 0.0 && isPosition(translation));  // NaN fails, too
  keyframe.T_camera_world.linear() = rotation;
  keyframe.T_camera_world.translation() = translation;
  const auto camera = in.get<std::uint32_t>();
  in.require(camera < cameras.size());
  keyframe.camera = cameras[camera];
  keyframe.parent = in.getId<KeyframeId>();
  keyframe.loop_edges.resize(in.getCount(sizeof(std::uint64_t)));
  for (KeyframeId& edge : keyframe.loop_edges) edge = in.getId<KeyframeId>();
  keyframe.features = readFeatures(in);
  return keyframe;
}

void writeLandmark(Writer& out, const Landmark& landmark) {
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

Landmark readLandmark(Reader& in) {
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
void checkLinks(const Reader& in, const std::map<KeyframeId, Keyframe>& keyframes,
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

/// @return offset of the payload
std::size_t checkHeader(const std::string& content, const std::string& name) {
  if (content.size() < sizeof(kMagic) || std::memcmp(content.data(), kMagic, sizeof(kMagic)) != 0) {
    throw FileError("'" + name + "' is no map file of semantic_vslam");
  }
  const std::string truncated = "map file '" + name + "' is truncated: save or copy it anew";
  if (content.size() < kHeaderBytes) throw FileError(truncated);
  Reader in(content, sizeof(kMagic), name);
  const auto version = in.get<std::uint32_t>();
  if (version != kFormatVersion) {
    throw FileError("map file '" + name + "' has format version " + std::to_string(version) + ", this program reads " +
                    std::to_string(kFormatVersion) + ": save it anew with this program");
  }
  const auto payload_bytes = in.get<std::uint64_t>();
  const auto checksum = in.get<std::uint32_t>();
  if (content.size() - kHeaderBytes < payload_bytes) throw FileError(truncated);
  if (content.size() - kHeaderBytes > payload_bytes ||
      crc32(content.data() + kHeaderBytes, content.size() - kHeaderBytes) != checksum) {
    throw FileError("map file '" + name + "' is damaged: its checksum does not fit; save or copy it anew");
  }
  return kHeaderBytes;
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
  Writer payload;
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

  Writer file;
  file.putBytes(kMagic, sizeof(kMagic));
  file.put(kFormatVersion);
  file.putCount(payload.bytes().size());
  file.put(crc32(payload.bytes().data(), payload.bytes().size()));
  file.bytes() += payload.bytes();
  return std::move(file.bytes());
}

void parseMap(const std::string& content, const std::string& name, Map& map) {
  Reader in(content, checkHeader(content, name), name);
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
}

void saveMap(const std::string& path, const Map& map) { writeTextAtomically(path, serializeMap(map)); }

void loadMap(const std::string& path, Map& map) {
  requireRegularFile("map file", path);
  std::ifstream file(path, std::ios::binary);
  if (!file) throw FileError("map file '" + path + "' cannot be opened: " + std::strerror(errno));
  const std::string content((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  if (file.bad()) throw FileError("map file '" + path + "' cannot be read: " + std::strerror(errno));
  parseMap(content, path, map);
}

void indexKeyframes(const Map& map, PlaceIndex& index) {
  for (const auto& [id, keyframe] : map.keyframes()) index.add(id, *keyframe.features);
}

}  // namespace semantic_vslam
