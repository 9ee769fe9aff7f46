// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "semantic_vslam/core/motion/mask_propagation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "semantic_vslam/core/motion/flow_carry.h"
#include "semantic_vslam/core/segmentation/dynamic_objects.h"

namespace semantic_vslam {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

cv::Mat2f identityOrigin(cv::Size size) {
  cv::Mat2f origin(size);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) origin(y, x) = {static_cast<float>(x), static_cast<float>(y)};
  }
  return origin;
}

/// One frame further. The origin is taken from the nearest cell plus the offset to it: interpolating would mix the
/// origins of a person and of the wall beside.
cv::Mat2f advanceOrigin(const cv::Mat2f& origin, const cv::Mat2f& flow_cells, const cv::Mat1f& previous_depth_m,
                        const cv::Mat1f& depth_m, double dt_s) {
  cv::Mat2f advanced(origin.size(), cv::Vec2f(kNan, kNan));
  for (int y = 0; y < origin.rows; ++y) {
    for (int x = 0; x < origin.cols; ++x) {
      const cv::Vec2f flow = flow_cells(y, x);
      const float before_x = static_cast<float>(x) - flow[0], before_y = static_cast<float>(y) - flow[1];
      const int column = cvRound(before_x), row = cvRound(before_y);
      if (column < 0 || row < 0 || column >= origin.cols || row >= origin.rows) continue;
      if (isUncovered(depth_m(y, x), previous_depth_m(row, column), static_cast<float>(dt_s))) continue;
      const cv::Vec2f offset(before_x - static_cast<float>(column), before_y - static_cast<float>(row));
      advanced(y, x) = origin(row, column) + offset;
    }
  }
  return advanced;
}

/// Share of each grid cell's pixels that belong to a person.
cv::Mat1f personShare(const cv::Mat1b& labels, const LabelSet& label_set, cv::Size grid_size) {
  cv::Mat1b table(1, 256, static_cast<uchar>(0));
  for (int i = 0; i < 256; ++i) table(0, i) = label_set.mobility(static_cast<uchar>(i)) == Mobility::kPerson ? 255 : 0;
  cv::Mat1b person, reduced;
  cv::LUT(labels, table, person);
  cv::resize(person, reduced, grid_size, 0, 0, cv::INTER_AREA);
  cv::Mat1f share;
  reduced.convertTo(share, CV_32F, 1.0 / 255.0);
  return share;
}

}  // namespace

MaskPropagation::MaskPropagation(const MaskPropagationConfig& config) : config_(config) {}

void MaskPropagation::reset() {
  entries_.clear();
  mask_.release();
  origin_.release();
}

void MaskPropagation::addFrame(const GridFrame& frame, const cv::Mat2f& flow_cells) {
  if (hasMask()) {
    if (flow_cells.empty() || entries_.empty()) {
      mask_.release();
    } else {
      const Entry& last = entries_.back();
      origin_ =
          advanceOrigin(origin_, flow_cells, last.depth_m, frame.depth_m, secondsBetween(last.stamp, frame.stamp));
      // Past three time constants next to nothing of the trust is left.
      if (secondsBetween(mask_stamp_, frame.stamp) > 3.0 * config_.time_constant_s) mask_.release();
    }
  }
  entries_.push_back({frame.stamp, flow_cells, frame.depth_m, cv::Mat1b(frame.depth_m.size(), 0)});
  while (secondsBetween(entries_.front().stamp, frame.stamp) > config_.max_delay_s) entries_.pop_front();
}

void MaskPropagation::setMoving(const cv::Mat1b& moving) {
  if (!entries_.empty()) entries_.back().moving = moving;
}

cv::Mat1f MaskPropagation::dynamicOf(const Entry& entry, const cv::Mat1b& labels, const LabelSet& label_set) const {
  const cv::Size size = entry.depth_m.size();
  cv::Mat1f dynamic = personShare(labels, label_set, size);
  cv::Mat1b reduced, removed;
  cv::resize(labels, reduced, size, 0, 0, cv::INTER_NEAREST);
  decideDynamic(reduced, label_set, entry.moving, config_.phi, &removed);  // eq. (5)
  cv::Mat1f whole_cells;
  removed.convertTo(whole_cells, CV_32F, 1.0 / 255.0);
  // People to a fraction of a cell, moving things to whole cells.
  return cv::max(dynamic, whole_cells);
}

bool MaskPropagation::addLabels(Stamp stamp, const cv::Mat1b& labels, const LabelSet& label_set) {
  const auto entry = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& e) { return e.stamp == stamp; });
  if (entry == entries_.end() || labels.empty()) return false;
  if (hasMask() && stamp < mask_stamp_) return false;  // a newer one is being carried already
  mask_ = dynamicOf(*entry, labels, label_set);
  mask_stamp_ = stamp;
  origin_ = identityOrigin(mask_.size());
  for (auto next = entry + 1; next != entries_.end(); ++next) {
    const Entry& last = *(next - 1);
    origin_ =
        advanceOrigin(origin_, next->flow_cells, last.depth_m, next->depth_m, secondsBetween(last.stamp, next->stamp));
  }
  return true;
}

cv::Mat1f MaskPropagation::dynamicNow() const {
  if (!hasMask()) return {};
  const double age_s = secondsBetween(mask_stamp_, entries_.back().stamp);
  const auto trust = static_cast<float>(std::exp(-age_s / config_.time_constant_s));
  cv::Mat1f dynamic(mask_.size(), kNan);
  const auto right = static_cast<float>(mask_.cols - 1), bottom = static_cast<float>(mask_.rows - 1);
  for (int y = 0; y < mask_.rows; ++y) {
    for (int x = 0; x < mask_.cols; ++x) {
      const cv::Vec2f at = origin_(y, x);
      if (std::isnan(at[0])) continue;
      const float value = sampleBilinear(mask_, std::clamp(at[0], 0.0F, right), std::clamp(at[1], 0.0F, bottom));
      dynamic(y, x) = 0.5F + trust * (value - 0.5F);
    }
  }
  return dynamic;
}

}  // namespace semantic_vslam
