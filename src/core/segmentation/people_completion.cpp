// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "semantic_vslam/core/segmentation/people_completion.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "semantic_vslam/core/camera/depth_quantum.h"
#include "semantic_vslam/core/segmentation/block_grid.h"

namespace semantic_vslam {
namespace {

/// How far two depths beside each other on one surface may lie apart: a surface turned away from the camera by 60
/// degrees, and one quantum of a structured-light camera.
class SurfaceStep {
 public:
  /// @param px  between the two  @param focal_px  focal length
  SurfaceStep(int px, double focal_px) : slope_(static_cast<float>(1.732 * px / focal_px)) {}
  bool holds(float a_m, float b_m) const {
    constexpr auto kQuantumPerM2 = static_cast<float>(kKinectStepPerM2);
    const float z = std::min(a_m, b_m);
    return std::abs(a_m - b_m) < z * (slope_ + kQuantumPerM2 * z);
  }

 private:
  float slope_;
};

}  // namespace

cv::Mat1b PeopleCompletion::complete(const Segmentation& segmentation, std::uint8_t person, const RgbdFrame& frame) {
  const cv::Mat1b& labels = segmentation.labels;
  const cv::Mat1b& weak = segmentation.weak_people;
  assert(labels.size() == frame.depth_m.size() && weak.size() == labels.size());
  takeEvery(stride_, labels, labels_);
  takeEvery(stride_, weak, weak_);
  takeEvery(stride_, frame.depth_m, depth_m_);
  const float* z = depth_m_.ptr<float>();
  const SurfaceStep step(stride_, std::min(frame.camera->fx(), frame.camera->fy()));
  cv::findNonZero(((labels_ == person) | weak_) & (depth_m_ > 0.0F), candidates_);
  connectRegions(
      depth_m_.size(), candidates_, [z, &step](int a, int b) { return step.holds(z[a], z[b]); }, surfaces_);

  std::vector<int> strong_px(surfaces_.count, 0);
  for (const cv::Point& p : candidates_) strong_px[surfaces_.id(p)] += labels_(p) == person;
  cv::Mat1b completed = labels.clone();
  for (const cv::Point& p : candidates_) {
    const int surface = surfaces_.id(p);
    if (strong_px[surface] < min_share_ * surfaces_.size_px[surface]) continue;
    const cv::Rect block = cv::Rect(p.x * stride_, p.y * stride_, stride_, stride_) & cv::Rect({0, 0}, labels.size());
    for (int v = block.y; v < block.y + block.height; ++v) {
      for (int u = block.x; u < block.x + block.width; ++u) {
        if (weak(v, u) != 0 && step.holds(frame.depth_m(v, u), depth_m_(p))) completed(v, u) = person;
      }
    }
  }
  return completed;
}

}  // namespace semantic_vslam
