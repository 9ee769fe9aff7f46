// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "core/segmentation/model_sidecar.h"

namespace semantic_vslam {

/// The input tensor of a network, in memory that stays where it is, and the way an image is put into it.
class NetworkInput {
 public:
  explicit NetworkInput(const ModelSidecar::Input& description);
  NetworkInput(const NetworkInput&) = delete;
  NetworkInput& operator=(const NetworkInput&) = delete;

  /// Resizes, reorders and normalises an image into the tensor.
  /// @param bgr  8-bit BGR, any size
  /// @return the size that the image has in the input, from its top left corner, px; the rest is letterbox padding.
  cv::Size fill(const cv::Mat3b& bgr);

  /// 1x3xHxW or 1xHxWx3.
  const std::vector<std::int64_t>& shape() const { return shape_; }
  std::size_t elements() const { return static_cast<std::size_t>(description_.size.area()) * 3; }
  std::uint8_t* bytes() { return canvas_to_bytes_ ? bytes_.data() : canvas_.data; }  ///< if description.type is kUint8
  float* floats() { return floats_.data(); }                                         ///< if it is kFloat32

 private:
  cv::Size contentSize(const cv::Size& image) const;
  template <class Element>
  void writeTensor(Element* tensor) const;

  const ModelSidecar::Input description_;
  std::vector<std::int64_t> shape_;
  bool canvas_to_bytes_ = false;  ///< the canvas itself is no uint8 tensor: it is planar
  cv::Mat3b canvas_;              ///< the image at the network's size, in the network's channel order
  std::vector<std::uint8_t> bytes_;
  std::vector<float> floats_;
};

}  // namespace semantic_vslam
