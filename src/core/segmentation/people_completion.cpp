// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/segmentation/people_completion.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/camera/depth_quantum.h"
#include "core/segmentation/block_grid.h"

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

void PeopleCompletion::complete(cv::Mat1b& labels, const cv::Mat1b& weak_people, std::uint8_t person,
                                const RgbdFrame& frame) {
  assert(labels.size() == frame.depth_m.size() && weak_people.size() == labels.size());
  takeEvery(stride_, labels, labels_);
  takeEvery(stride_, weak_people, weak_);
  takeEvery(stride_, frame.depth_m, depth_m_);
  const float* z = depth_m_.ptr<float>();
  const SurfaceStep step(stride_, std::min(frame.camera->fx(), frame.camera->fy()));
  cv::findNonZero(((labels_ == person) | weak_) & (depth_m_ > 0.0F), candidates_);
  connectRegions(
      depth_m_.size(), candidates_, [z, &step](int a, int b) { return step.holds(z[a], z[b]); }, surfaces_);

  std::vector<int> strong_px(surfaces_.count, 0);
  for (const cv::Point& p : candidates_) strong_px[surfaces_.id(p)] += labels_(p) == person;
  taken_.create(labels_.size());
  taken_.setTo(0);
  for (const cv::Point& p : candidates_) {
    const int surface = surfaces_.id(p);
    if (strong_px[surface] >= min_share_ * surfaces_.size_px[surface]) taken_(p) = 255;
  }
  const int width = labels.cols;
  std::vector<std::uint8_t> taken_row;
  std::vector<float> level_row;
  for (int row = 0; row < taken_.rows; ++row) {
    if (cv::countNonZero(taken_.row(row)) == 0) continue;
    const std::uint8_t* taken = expandRow(stride_, taken_, row, taken_row);
    const float* level_m = expandRow(stride_, depth_m_, row, level_row);
    for (int v = row * stride_; v < std::min((row + 1) * stride_, labels.rows); ++v) {
      const std::uint8_t* weak_person = weak_people[v];
      const float* depth = frame.depth_m[v];
      std::uint8_t* label = labels[v];
      for (int u = 0; u < width; ++u) {
        const bool takes = (taken[u] != 0) & (weak_person[u] != 0) & step.holds(depth[u], level_m[u]);
        label[u] = takes ? person : label[u];
      }
    }
  }
}

}  // namespace semantic_vslam
