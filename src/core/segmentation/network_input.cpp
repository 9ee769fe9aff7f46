// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/segmentation/network_input.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace semantic_vslam {
namespace {

/// Averaging, where more than two pixels fall into one; bilinear otherwise.
int interpolation(const cv::Size& from, const cv::Size& to) {
  return from.width >= 2 * to.width && from.height >= 2 * to.height ? cv::INTER_AREA : cv::INTER_LINEAR;
}

}  // namespace

NetworkInput::NetworkInput(const ModelSidecar::Input& description) : description_(description) {
  const std::int64_t width = description_.size.width, height = description_.size.height;
  const bool planar = description_.layout == TensorLayout::kNchw;
  shape_ = planar ? std::vector<std::int64_t>{1, 3, height, width} : std::vector<std::int64_t>{1, height, width, 3};
  canvas_.create(description_.size);
  canvas_.setTo(cv::Scalar::all(description_.pad_value));
  canvas_to_bytes_ = description_.type == TensorType::kUint8 && planar;
  if (canvas_to_bytes_) bytes_.resize(elements());
  if (description_.type == TensorType::kFloat32) floats_.resize(elements());
}

cv::Size NetworkInput::contentSize(const cv::Size& image) const {
  const cv::Size full = description_.size;
  if (description_.resize == ResizeMode::kStretch) return full;
  const double scale =
      std::min(static_cast<double>(full.width) / image.width, static_cast<double>(full.height) / image.height);
  return {std::clamp(cvRound(image.width * scale), 1, full.width),
          std::clamp(cvRound(image.height * scale), 1, full.height)};
}

cv::Size NetworkInput::fill(const cv::Mat3b& bgr) {
  const cv::Size content = contentSize(bgr.size());
  if (content != canvas_.size()) canvas_.setTo(cv::Scalar::all(description_.pad_value));
  cv::Mat part = canvas_(cv::Rect({0, 0}, content));
  cv::resize(bgr, part, content, 0.0, 0.0, interpolation(bgr.size(), content));
  if (description_.channels == ChannelOrder::kRgb) cv::cvtColor(part, part, cv::COLOR_BGR2RGB);
  if (description_.type == TensorType::kFloat32) {
    writeTensor(floats_.data());
  } else if (canvas_to_bytes_) {
    writeTensor(bytes_.data());
  }
  return content;
}

template <class Element>
void NetworkInput::writeTensor(Element* tensor) const {
  const bool planar = description_.layout == TensorLayout::kNchw;
  const std::size_t pixels = description_.size.area();
  const std::uint8_t* from = canvas_.ptr<std::uint8_t>();
  for (int c = 0; c < 3; ++c) {
    const auto gain = static_cast<float>(description_.scale / description_.std[c]);
    const auto offset = static_cast<float>(-description_.mean[c] / description_.std[c]);
    Element* to = planar ? tensor + c * pixels : tensor + c;
    const std::size_t step = planar ? 1 : 3;
    for (std::size_t i = 0; i < pixels; ++i) to[i * step] = static_cast<Element>(from[3 * i + c] * gain + offset);
  }
}

}  // namespace semantic_vslam
