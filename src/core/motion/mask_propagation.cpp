// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/motion/mask_propagation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "core/labels/dynamic_objects.h"

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
cv::Mat2f advanceOrigin(const cv::Mat2f& origin, const cv::Mat2f& source) {
  cv::Mat2f advanced(origin.size());
  for (int y = 0; y < origin.rows; ++y) {
    const cv::Vec2f* from = source[y];
    cv::Vec2f* out = advanced[y];
    for (int x = 0; x < origin.cols; ++x) {
      if (!(from[x][0] >= 0.0F)) {  // NaN
        out[x] = {kNan, kNan};
        continue;
      }
      const int column = static_cast<int>(from[x][0] + 0.5F), row = static_cast<int>(from[x][1] + 0.5F);
      const cv::Vec2f& nearest = origin(row, column);
      out[x] = {nearest[0] + from[x][0] - static_cast<float>(column),
                nearest[1] + from[x][1] - static_cast<float>(row)};
    }
  }
  return advanced;
}

/// The mask where each cell comes from; NaN = lost.
cv::Mat1f sampleMask(const cv::Mat1f& mask, const cv::Mat2f& origin) {
  cv::Mat1f sampled(mask.size(), kNan);
  const auto right = static_cast<float>(mask.cols - 1), bottom = static_cast<float>(mask.rows - 1);
  for (int y = 0; y < mask.rows; ++y) {
    for (int x = 0; x < mask.cols; ++x) {
      const cv::Vec2f at = origin(y, x);
      if (std::isnan(at[0])) continue;
      sampled(y, x) = sampleBilinear(mask, std::clamp(at[0], 0.0F, right), std::clamp(at[1], 0.0F, bottom));
    }
  }
  return sampled;
}

/// Share of each grid cell's pixels that belong to a person.
cv::Mat1f personShare(const cv::Mat1b& labels, const LabelSet& label_set, cv::Size grid_size) {
  cv::Mat1b reduced;
  cv::resize(maskOfPeople(labels, label_set), reduced, grid_size, 0, 0, cv::INTER_AREA);
  cv::Mat1f share;
  reduced.convertTo(share, CV_32F, 1.0 / 255.0);
  return share;
}

}  // namespace

MaskPropagation::MaskPropagation(const MaskPropagationConfig& config, const RemovalConfig& removal)
    : config_(config), removal_(removal) {}

void MaskPropagation::reset() {
  entries_.clear();
  mask_.release();
  origin_.release();
}

void MaskPropagation::addFrame(Stamp stamp, cv::Size grid_size, const cv::Mat2f& source) {
  // Past three time constants next to nothing of the trust is left.
  const bool expired = hasMask() && secondsBetween(mask_stamp_, stamp) > 3.0 * config_.time_constant_s;
  if (expired || source.empty()) mask_.release();
  if (hasMask()) origin_ = advanceOrigin(origin_, source);
  entries_.push_back({stamp, source, cv::Mat1b(grid_size, 0), {}});
  while (secondsBetween(entries_.front().stamp, stamp) > config_.max_delay_s) entries_.pop_front();
}

void MaskPropagation::setMoving(const cv::Mat1b& moving) {
  if (!entries_.empty() && !moving.empty()) entries_.back().moving = moving;
}

void MaskPropagation::setPlace(const PlacedFrame& place) {
  if (!entries_.empty()) entries_.back().place = place;
}

void MaskPropagation::forgetPlaces() {
  for (Entry& entry : entries_) entry.place.reset();
}

cv::Mat1f MaskPropagation::dynamicOf(const Entry& entry, const cv::Mat1b& labels, const LabelSet& label_set) const {
  const cv::Size size = entry.moving.size();
  cv::Mat1f dynamic = personShare(labels, label_set, size);
  cv::Mat1b reduced, removed;
  cv::resize(labels, reduced, size, 0, 0, cv::INTER_NEAREST);
  decideDynamic(reduced, label_set, entry.moving, removal_.phi, &removed);  // eq. (5)
  cv::Mat1f whole_cells;
  removed.convertTo(whole_cells, CV_32F, 1.0 / 255.0);
  // People to a fraction of a cell, moving things to whole cells.
  return cv::max(dynamic, whole_cells);
}

bool MaskPropagation::addLabels(Stamp stamp, const cv::Mat1b& labels, const LabelSet& label_set, const Weigh& weigh) {
  const auto entry = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& e) { return e.stamp == stamp; });
  if (entry == entries_.end() || labels.empty()) return false;
  if (hasMask() && stamp <= mask_stamp_) return false;  // these or newer ones are being carried already
  mask_ = dynamicOf(*entry, labels, label_set);
  if (weigh && entry->place) mask_ = weigh(mask_, *entry->place);
  mask_stamp_ = stamp;
  origin_ = identityOrigin(mask_.size());
  for (auto next = entry + 1; next != entries_.end(); ++next) origin_ = advanceOrigin(origin_, next->source);
  return true;
}

cv::Mat1f MaskPropagation::dynamicNow() const {
  if (!hasMask()) return {};
  const double age_s = secondsBetween(mask_stamp_, entries_.back().stamp);
  const auto trust = static_cast<float>(std::exp(-age_s / config_.time_constant_s));
  cv::Mat1f dynamic = sampleMask(mask_, origin_);
  changeCells(dynamic, [trust](float value) { return 0.5F + trust * (value - 0.5F); });
  return dynamic;
}

}  // namespace semantic_vslam
