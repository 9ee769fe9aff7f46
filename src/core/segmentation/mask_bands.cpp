// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/segmentation/mask_bands.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/camera/depth_quantum.h"

namespace semantic_vslam {
namespace {

/// The masks' pixels that another mask or the background is beside, in four directions; in raster order.
std::vector<int> findBorder(const ConnectedRegions& masks, const std::vector<cv::Point>& labelled) {
  const int width = masks.id.cols, height = masks.id.rows;
  const int* id = masks.id.ptr<int>();
  std::vector<int> border;
  for (const cv::Point& p : labelled) {
    const int i = p.y * width + p.x, mask = id[i];
    const bool on_border = (p.x > 0 && id[i - 1] != mask) || (p.x + 1 < width && id[i + 1] != mask) ||
                           (p.y > 0 && id[i - width] != mask) || (p.y + 1 < height && id[i + width] != mask);
    if (on_border) border.push_back(i);
  }
  return border;
}

/// Distance from some pixels on the way that growth takes, px in four directions, up to a limit; 255 beyond it.
void growthDistance(std::vector<int> front, const Steps& steps, int limit_px, cv::Mat1b& distance) {
  const int width = distance.cols, height = distance.rows;
  distance.setTo(255);
  std::uint8_t* distance_of = distance.ptr<std::uint8_t>();
  for (const int i : front) distance_of[i] = 0;
  std::vector<int> next;
  for (int d = 1; d <= limit_px && !front.empty(); ++d) {
    next.clear();
    const auto visit = [&](int from, int to) {
      if (distance_of[to] != 255 || !steps.joined(from, to)) return;
      distance_of[to] = static_cast<std::uint8_t>(d);
      next.push_back(to);
    };
    for (const int i : front) {
      const int u = i % width, v = i / width;
      if (u > 0) visit(i, i - 1);
      if (u + 1 < width) visit(i, i + 1);
      if (v > 0) visit(i, i - width);
      if (v + 1 < height) visit(i, i + width);
    }
    std::swap(front, next);
  }
}

/// Bands between a step, on whose far side they lie, and the mask's border: growth reaches them where the object
/// touches what it stands on.
void findHiddenBackground(const std::vector<int>& border, const ConnectedRegions& masks,
                          const std::vector<cv::Point>& labelled, const Steps& steps, int width_px, cv::Mat1b& bands,
                          cv::Mat1b& scratch) {
  const int width = masks.id.cols;
  std::vector<int> hidden, last_in_column(width, -1);
  const auto compare = [&](int before, int now) {  // both have depth; holes between them are looked across
    if (before < 0 || !steps.sameMask(before, now)) return;
    const int behind = steps.behind(before, now);
    if (behind >= 0) hidden.push_back(behind);
  };
  int last_in_row = -1, row = -1;
  for (const cv::Point& p : labelled) {
    const int i = p.y * width + p.x;
    if (p.y != row) last_in_row = -1;
    row = p.y;
    if (!steps.hasDepth(i)) continue;
    compare(last_in_row, i);
    compare(last_in_column[p.x], i);
    last_in_row = last_in_column[p.x] = i;
  }
  bands.create(masks.id.size());
  scratch.create(masks.id.size());
  growthDistance(border, steps, width_px, bands);
  growthDistance(std::move(hidden), steps, width_px, scratch);
  cv::add(bands, scratch, scratch);  // saturates: what one of them does not reach stays 255
  cv::compare(scratch, width_px, bands, cv::CMP_LT);
}

/// A line through the inverse depths along a row or column: a plane in space is one in the image.
struct InverseDepthLine {
  bool known = false;
  float slope = 0.0F, offset = 0.0F;

  /// @param outside  z of the background pixels beside a mask, the nearest first; 0: none
  static InverseDepthLine fit(const float* outside, std::ptrdiff_t step, int count) {
    constexpr int kFewest = 4;
    float n = 0.0F, t1 = 0.0F, t2 = 0.0F, w1 = 0.0F, tw = 0.0F;
    for (int k = 1; k < count; ++k) {  // the pixel next to the mask is left out: sensors blur an edge
      const float z = outside[k * step];
      if (z == 0.0F) continue;
      const float t = static_cast<float>(-k), w = 1.0F / z;
      n += 1.0F;
      t1 += t;
      t2 += t * t;
      w1 += w;
      tw += t * w;
    }
    InverseDepthLine line;
    line.known = n >= kFewest;
    if (!line.known) return line;
    line.slope = (n * tw - t1 * w1) / (n * t2 - t1 * t1);
    line.offset = (w1 - line.slope * t1) / n;
    return line;
  }
  /// @param step  1: the mask's first pixel
  bool meets(float z, int step) const {
    constexpr auto kTolerance = static_cast<float>(3.0 * kKinectStepPerM2);  // three quanta: 9 mm at 1 m
    return std::abs(1.0F / z - offset - slope * static_cast<float>(step)) < kTolerance;
  }
};

/// What a mask that is too large shows of the floor or wall that its object touches, where no depth edge parts them:
/// pixels inside its border that continue the plane outside, if that ends within width_px. If it goes on, the mask is
/// rather too small there, and all of it the object.
class ContinuedBackground {
 public:
  ContinuedBackground(const ConnectedRegions& masks, const cv::Mat1f& depth_m, int width_px, cv::Mat1b& bands)
      : id_(masks.id.ptr<int>()), z_(depth_m.ptr<float>()), width_px_(width_px), bands_(bands.ptr<std::uint8_t>()) {}

  /// @param border   pixel of a mask whose neighbour, `outwards` before it in memory, is background
  /// @param outside, inside  pixels up to the image's edge before it, and from it on
  void follow(int border, std::ptrdiff_t outwards, int outside, int inside) {
    constexpr int kFitted = 10;
    int background = 0;
    while (background < std::min(outside, kFitted) && id_[border + (background + 1) * outwards] < 0) ++background;
    const InverseDepthLine line = InverseDepthLine::fit(z_ + border + outwards, outwards, background);
    if (!line.known) return;
    int end = 0;
    const auto at = [=](int k) { return border - k * outwards; };
    while (end < std::min(inside, width_px_) && id_[at(end)] == id_[border] &&
           (z_[at(end)] == 0.0F || line.meets(z_[at(end)], end + 1))) {
      ++end;
    }
    if (end == std::min(inside, width_px_) || id_[at(end)] != id_[border]) return;
    for (int k = 0; k < end; ++k) bands_[at(k)] = 255;
  }

 private:
  const int* id_;
  const float* z_;
  const int width_px_;
  std::uint8_t* bands_;
};

void findContinuedBackground(const std::vector<int>& border, const ConnectedRegions& masks, const cv::Mat1f& depth_m,
                             int width_px, cv::Mat1b& bands) {
  const int width = masks.id.cols, height = masks.id.rows;
  ContinuedBackground background(masks, depth_m, width_px, bands);
  const int* id = masks.id.ptr<int>();
  for (const int i : border) {
    const int u = i % width, v = i / width;
    if (u > 0 && id[i - 1] < 0) background.follow(i, -1, u, width - u);
    if (u + 1 < width && id[i + 1] < 0) background.follow(i, 1, width - 1 - u, u + 1);
    if (v > 0 && id[i - width] < 0) background.follow(i, -width, v, height - v);
    if (v + 1 < height && id[i + width] < 0) background.follow(i, width, height - 1 - v, v + 1);
  }
}

}  // namespace

void findBands(const ConnectedRegions& masks, const std::vector<cv::Point>& labelled, const Steps& steps,
               const cv::Mat1f& depth_m, int width_px, cv::Mat1b& bands, cv::Mat1b& scratch) {
  const std::vector<int> border = findBorder(masks, labelled);
  findHiddenBackground(border, masks, labelled, steps, width_px, bands, scratch);
  findContinuedBackground(border, masks, depth_m, width_px, bands);
}

}  // namespace semantic_vslam
