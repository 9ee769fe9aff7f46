// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/segmentation/label_picture.h"

#include <array>
#include <cassert>
#include <opencv2/imgproc.hpp>

namespace semantic_vslam {
namespace {

constexpr double kTint = 0.55;  // strong enough to name the class, weak enough to see the object

void drawLegend(cv::Mat3b& picture, const std::array<bool, 256>& shown, const LabelSet& label_set) {
  constexpr int kLineHeightPx = 18;
  int y = 4;
  for (std::size_t label = 1; label < label_set.size(); ++label) {
    if (!shown[label]) continue;
    const LabelClass& entry = label_set.classes[label];
    cv::rectangle(picture, cv::Rect(4, y, 14, 14), cv::Scalar(entry.color_bgr), cv::FILLED);
    const cv::Point at(24, y + 12);
    cv::putText(picture, entry.name, at, cv::FONT_HERSHEY_SIMPLEX, 0.45, cv::Scalar::all(0), 3, cv::LINE_AA);
    cv::putText(picture, entry.name, at, cv::FONT_HERSHEY_SIMPLEX, 0.45, cv::Scalar::all(255), 1, cv::LINE_AA);
    y += kLineHeightPx;
  }
}

}  // namespace

cv::Mat3b labelColours(const cv::Mat1b& labels, const LabelSet& label_set) {
  cv::Mat3b colours(labels.size());
  for (int v = 0; v < labels.rows; ++v) {
    for (int u = 0; u < labels.cols; ++u) {
      const std::uint8_t label = labels(v, u);
      colours(v, u) = label < label_set.size() ? label_set.classes[label].color_bgr : cv::Vec3b(0, 0, 0);
    }
  }
  return colours;
}

cv::Mat3b drawLabels(const cv::Mat3b& bgr, const cv::Mat1b& labels, const LabelSet& label_set) {
  assert(bgr.size() == labels.size());
  cv::Mat3b tinted;
  cv::addWeighted(bgr, 1.0 - kTint, labelColours(labels, label_set), kTint, 0.0, tinted);
  cv::Mat3b picture = bgr.clone();
  std::array<bool, 256> shown{};
  for (int v = 0; v < labels.rows; ++v) {
    for (int u = 0; u < labels.cols; ++u) {
      const std::uint8_t label = labels(v, u);
      shown[label] = true;
      const bool edge =
          (u + 1 < labels.cols && labels(v, u + 1) != label) || (v + 1 < labels.rows && labels(v + 1, u) != label);
      if (edge) {
        picture(v, u) = cv::Vec3b(255, 255, 255);
      } else if (label != 0) {
        picture(v, u) = tinted(v, u);
      }
    }
  }
  drawLegend(picture, shown, label_set);
  return picture;
}

}  // namespace semantic_vslam
