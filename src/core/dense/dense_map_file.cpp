// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/dense/dense_map_file.h"

#include <cmath>

#include "core/common/binary_file.h"
#include "core/geometry/binary_pose.h"

namespace semantic_vslam {
namespace {

constexpr BinaryFormat kFormat = {"SVDENSE\n", 2, "dense map file"};

constexpr std::size_t kPointBytes = 3 * sizeof(float) + 4;

template <class T>
void putImage(BinaryWriter& out, const cv::Mat_<T>& image) {
  const cv::Mat_<T> whole = image.isContinuous() ? image : cv::Mat_<T>(image.clone());
  out.put<std::int32_t>(whole.rows);
  out.put<std::int32_t>(whole.cols);
  out.putBytes(whole.data, whole.total() * sizeof(T));
}

template <class T>
cv::Mat_<T> getImage(BinaryReader& in) {
  constexpr int kLongestSide = 4096;
  const auto rows = in.get<std::int32_t>(), columns = in.get<std::int32_t>();
  in.require(rows >= 0 && columns >= 0 && rows <= kLongestSide && columns <= kLongestSide);
  cv::Mat_<T> image(rows, columns);
  in.getBytes(image.data, image.total() * sizeof(T));
  return image;
}

/// What a keyframe and a look have in common.
void putSeen(BinaryWriter& out, std::uint64_t order, const KeyframeCloud& cloud, const FreeSpaceView& view) {
  out.put(order);
  out.put(cloud.stamp.ns);
  out.putCount(cloud.points.size());
  for (const LabelledPoint& point : cloud.points) {
    out.putBytes(point.xyz_m.val, sizeof(point.xyz_m.val));
    out.putBytes(point.bgr.val, sizeof(point.bgr.val));
    out.put(point.label);
  }
  for (const double value : {view.fx_cells, view.fy_cells, view.cx_cells, view.cy_cells, view.noise_m_per_m2}) {
    out.put(value);
  }
  putImage(out, view.free_mm);
  putImage(out, view.inverse_depth);
}

void put(BinaryWriter& out, const DenseKeyframe& keyframe) {
  out.putId(keyframe.cloud.keyframe);
  putPose(out, keyframe.T_world_camera);
  out.put<std::uint8_t>(keyframe.thinned ? 1 : 0);
  out.put<std::uint8_t>(keyframe.culled ? 1 : 0);
  putSeen(out, keyframe.order, keyframe.cloud, keyframe.view);
  out.putCount(keyframe.looks.size());
  for (const DenseLook& look : keyframe.looks) {
    putPose(out, look.T_keyframe_camera);
    putSeen(out, look.order, look.cloud, look.view);
  }
}

void getSeen(BinaryReader& in, std::size_t labels, std::uint64_t& order, KeyframeCloud& cloud, FreeSpaceView& view) {
  order = in.get<std::uint64_t>();
  cloud.stamp.ns = in.get<std::int64_t>();
  cloud.points.resize(in.getCount(kPointBytes));
  for (LabelledPoint& point : cloud.points) {
    in.getBytes(point.xyz_m.val, sizeof(point.xyz_m.val));
    in.getBytes(point.bgr.val, sizeof(point.bgr.val));
    point.label = in.get<std::uint8_t>();
    in.require(isPosition(point.position()) && point.label < labels);
  }
  for (double* value : {&view.fx_cells, &view.fy_cells, &view.cx_cells, &view.cy_cells, &view.noise_m_per_m2}) {
    *value = in.get<double>();
    in.require(std::isfinite(*value));
  }
  in.require(view.fx_cells > 0.0 && view.fy_cells > 0.0 && view.noise_m_per_m2 >= 0.0);
  view.free_mm = getImage<std::uint16_t>(in);
  view.inverse_depth = getImage<float>(in);
  in.require(view.inverse_depth.empty() || view.inverse_depth.size() == view.free_mm.size());
  in.require(cv::checkRange(view.inverse_depth, true, nullptr, -1e6, 1e6));
}

DenseKeyframe getKeyframe(BinaryReader& in, std::size_t labels) {
  DenseKeyframe keyframe;
  keyframe.cloud.keyframe = in.getId<KeyframeId>();
  keyframe.T_world_camera = getPose(in);
  keyframe.thinned = in.get<std::uint8_t>() != 0;
  keyframe.culled = in.get<std::uint8_t>() != 0;
  getSeen(in, labels, keyframe.order, keyframe.cloud, keyframe.view);
  keyframe.looks.resize(in.getCount(1));
  for (DenseLook& look : keyframe.looks) {
    look.T_keyframe_camera = getPose(in);
    look.cloud.keyframe = keyframe.cloud.keyframe;
    getSeen(in, labels, look.order, look.cloud, look.view);
    in.require(look.order > keyframe.order);
  }
  return keyframe;
}

}  // namespace

std::string serializeDenseMap(const DenseMapContent& content) {
  BinaryWriter out;
  out.put(content.map_id);
  out.putCount(content.labels.size());
  for (const LabelClass& label : content.labels.classes) {
    out.putText(label.name);
    out.put(static_cast<std::uint8_t>(label.mobility));
    for (int i = 0; i < 3; ++i) out.put(label.color_bgr[i]);
  }
  out.putCount(content.keyframes.size());
  for (const DenseKeyframe& keyframe : content.keyframes) put(out, keyframe);
  return out.file(kFormat);
}

DenseMapContent parseDenseMap(const std::string& bytes, const std::string& name) {
  constexpr std::size_t kMostLabels = 256;
  BinaryReader in(bytes, kFormat, name);
  DenseMapContent content;
  content.map_id = in.get<std::uint32_t>();
  content.labels.classes.clear();
  const std::size_t labels = in.getCount(1);
  in.require(labels > 0 && labels <= kMostLabels);
  for (std::size_t i = 0; i < labels; ++i) {
    LabelClass label;
    label.name = in.getText();
    const auto mobility = in.get<std::uint8_t>();
    in.require(mobility <= static_cast<std::uint8_t>(Mobility::kPerson));
    label.mobility = static_cast<Mobility>(mobility);
    for (int c = 0; c < 3; ++c) label.color_bgr[c] = in.get<std::uint8_t>();
    content.labels.classes.push_back(label);
  }
  for (std::size_t i = in.getCount(1); i > 0; --i) {
    content.keyframes.push_back(getKeyframe(in, labels));
    const std::size_t last = content.keyframes.size() - 1;
    in.require(last == 0 || content.keyframes[last - 1].cloud.keyframe < content.keyframes[last].cloud.keyframe);
  }
  in.require(in.atEnd());
  return content;
}

DenseMapContent readDenseMap(const std::string& path) { return parseDenseMap(readBinaryFile(kFormat, path), path); }

}  // namespace semantic_vslam
