// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "semantic_vslam/core/camera/rgbd_frame.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

// Structured-light and stereo depth cameras carry no usable signal past this; a larger value is a broken pixel.
constexpr float kMaxDepthM = 20.0F;

std::string sizeText(const cv::Size& size) { return std::to_string(size.width) + "x" + std::to_string(size.height); }

bool isUsable(float depth_m) { return depth_m >= 0.0F && depth_m <= kMaxDepthM; }  // written so that NaN is not

cv::Mat1f depthInMetres(const cv::Mat& depth, double depth_unit_m) {
  cv::Mat1f metres;
  if (depth.type() == CV_32FC1) {
    const cv::Mat1f given = depth;
    if (std::all_of(given.begin(), given.end(), isUsable)) return given;
    metres = given.clone();
  } else if (depth.type() == CV_16UC1) {
    depth.convertTo(metres, CV_32F, depth_unit_m);
  } else {
    throw Error("depth image has OpenCV type " + cv::typeToString(depth.type()) +
                ", must be 32FC1 (metres) or 16UC1 (millimetres)");
  }
  for (float& z : metres) {
    if (!isUsable(z)) z = 0.0F;
  }
  return metres;
}

}  // namespace

RgbdFrame makeRgbdFrame(std::uint64_t index, Stamp stamp, const cv::Mat& bgr, const cv::Mat& depth, double depth_unit_m,
                        std::shared_ptr<const CameraModel> camera) {
  const cv::Size expected(camera->width(), camera->height());
  if (bgr.empty()) throw Error("colour image is empty");
  if (depth.empty()) throw Error("depth image is empty");
  if (bgr.size() != expected) {
    throw Error("colour image is " + sizeText(bgr.size()) + " but the camera model says " + sizeText(expected));
  }
  if (depth.size() != expected) {
    throw Error("depth image is " + sizeText(depth.size()) + " but colour is " + sizeText(expected) +
                "; publish depth registered to colour (align_depth:=true, or depth_registered)");
  }
  RgbdFrame frame;
  frame.index = index;
  frame.stamp = stamp;
  frame.camera = std::move(camera);
  if (bgr.type() == CV_8UC3) {
    frame.bgr = bgr;
    cv::cvtColor(bgr, frame.gray, cv::COLOR_BGR2GRAY);
  } else if (bgr.type() == CV_8UC1) {
    frame.gray = bgr;
    cv::cvtColor(bgr, frame.bgr, cv::COLOR_GRAY2BGR);
  } else {
    throw Error("colour image has OpenCV type " + cv::typeToString(bgr.type()) + ", must be 8UC3 (BGR) or 8UC1 (gray)");
  }
  frame.depth_m = depthInMetres(depth, depth_unit_m);
  return frame;
}

}  // namespace semantic_vslam
