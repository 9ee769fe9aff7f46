// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/dense/dense_map_file.h"

#include <cmath>

#include "core/common/binary_file.h"
#include "core/geometry/binary_pose.h"

namespace semantic_vslam {
namespace {

constexpr BinaryFormat kFormat = {"SVDENSE\n", 1, "dense map file"};

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

void put(BinaryWriter& out, const DenseKeyframe& keyframe) {
  out.putId(keyframe.cloud.keyframe);
  out.put(keyframe.cloud.stamp.ns);
  putPose(out, keyframe.T_world_camera);
  out.put<std::uint8_t>(keyframe.thinned ? 1 : 0);
  out.put<std::uint8_t>(keyframe.culled ? 1 : 0);
  out.putCount(keyframe.cloud.points.size());
  for (const LabelledPoint& point : keyframe.cloud.points) {
    out.putBytes(point.xyz_m.val, sizeof(point.xyz_m.val));
    out.putBytes(point.bgr.val, sizeof(point.bgr.val));
    out.put(point.label);
  }
  const FreeSpaceView& view = keyframe.view;
  for (const double value : {view.fx_cells, view.fy_cells, view.cx_cells, view.cy_cells, view.noise_m_per_m2}) {
    out.put(value);
  }
  putImage(out, view.free_mm);
  putImage(out, view.inverse_depth);
}

DenseKeyframe getKeyframe(BinaryReader& in, std::size_t labels) {
  DenseKeyframe keyframe;
  keyframe.cloud.keyframe = in.getId<KeyframeId>();
  keyframe.cloud.stamp.ns = in.get<std::int64_t>();
  keyframe.T_world_camera = getPose(in);
  keyframe.thinned = in.get<std::uint8_t>() != 0;
  keyframe.culled = in.get<std::uint8_t>() != 0;
  keyframe.cloud.points.resize(in.getCount(kPointBytes));
  for (LabelledPoint& point : keyframe.cloud.points) {
    in.getBytes(point.xyz_m.val, sizeof(point.xyz_m.val));
    in.getBytes(point.bgr.val, sizeof(point.bgr.val));
    point.label = in.get<std::uint8_t>();
    in.require(isPosition(point.position()) && point.label < labels);
  }
  FreeSpaceView& view = keyframe.view;
  for (double* value : {&view.fx_cells, &view.fy_cells, &view.cx_cells, &view.cy_cells, &view.noise_m_per_m2}) {
    *value = in.get<double>();
    in.require(std::isfinite(*value));
  }
  in.require(view.fx_cells > 0.0 && view.fy_cells > 0.0 && view.noise_m_per_m2 >= 0.0);
  view.free_mm = getImage<std::uint16_t>(in);
  view.inverse_depth = getImage<float>(in);
  in.require(view.inverse_depth.empty() || view.inverse_depth.size() == view.free_mm.size());
  in.require(cv::checkRange(view.inverse_depth, true, nullptr, 0.0, 1e6));
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
