// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/motion/work_grid.h"

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace semantic_vslam {
namespace {

cv::Size gridSize(const CameraModel& camera, int flow_width_px) {
  const int width = std::max(8, std::min(flow_width_px, camera.width()) / 2);
  const double scale = static_cast<double>(camera.width()) / width;
  return {width, std::max(8, static_cast<int>(std::lround(camera.height() / scale)))};
}

/// Depth at each cell's centre; a hole is filled from the cell's other pixels, so that thin holes do not widen.
cv::Mat1f sampleDepth(const cv::Mat1f& depth_m, cv::Size size) {
  cv::Mat1f sampled(size);
  const float step_x = static_cast<float>(depth_m.cols) / static_cast<float>(size.width);
  const float step_y = static_cast<float>(depth_m.rows) / static_cast<float>(size.height);
  const auto pixel = [](int cell, float part, float step, int count) {
    return std::min(static_cast<int>((static_cast<float>(cell) + part) * step), count - 1);
  };
  std::vector<int> left(size.width), right(size.width);
  for (int x = 0; x < size.width; ++x) {
    left[x] = pixel(x, 0.25F, step_x, depth_m.cols);
    right[x] = pixel(x, 0.75F, step_x, depth_m.cols);
  }
  for (int y = 0; y < size.height; ++y) {
    const float* top = depth_m[pixel(y, 0.25F, step_y, depth_m.rows)];
    const float* bottom = depth_m[pixel(y, 0.75F, step_y, depth_m.rows)];
    float* out = sampled[y];
    for (int x = 0; x < size.width; ++x) {
      out[x] = bottom[right[x]];
      if (out[x] > 0.0F) continue;
      const float upper = top[left[x]] > 0.0F ? top[left[x]] : top[right[x]];
      out[x] = upper > 0.0F ? upper : bottom[left[x]];
    }
  }
  return sampled;
}

cv::Mat1f gradientMagnitude(const cv::Mat1b& gray) {
  cv::Mat1f magnitude(gray.size(), 0.0F);
  for (int y = 1; y + 1 < gray.rows; ++y) {
    const uchar *above = gray[y - 1], *here = gray[y], *below = gray[y + 1];
    float* out = magnitude[y];
    for (int x = 1; x + 1 < gray.cols; ++x) {
      out[x] = 0.5F * static_cast<float>(std::abs(here[x + 1] - here[x - 1]) + std::abs(below[x] - above[x]));
    }
  }
  return magnitude;
}

// Stands for "no depth" where the nearest is looked for; farther than any sensor reads.
constexpr float kFarM = 1e3F;
// Holes take their range of depth from blocks of this size about them: 8 cells reach over 32 to 64 px.
constexpr int kHoleBlockCells = 8;

/// Gives holes that no depth touches the range of depth of the blocks about them.
/// @param no_holes  depth with kFarM in the place of holes
void fillHoles(GridFrame& frame, const cv::Mat1f& no_holes) {
  const cv::Size size = frame.depth_m.size();
  const cv::Size blocks((size.width + kHoleBlockCells - 1) / kHoleBlockCells,
                        (size.height + kHoleBlockCells - 1) / kHoleBlockCells);
  cv::Mat1f low(blocks, kFarM), high(blocks, 0.0F);
  for (int y = 0; y < size.height; ++y) {
    const float *depth = frame.depth_m[y], *filled = no_holes[y];
    float *low_row = low[y / kHoleBlockCells], *high_row = high[y / kHoleBlockCells];
    for (int block = 0; block < blocks.width; ++block) {
      const int begin = block * kHoleBlockCells, end = std::min(begin + kHoleBlockCells, size.width);
      for (int x = begin; x < end; ++x) {
        low_row[block] = std::min(low_row[block], filled[x]);
        high_row[block] = std::max(high_row[block], depth[x]);
      }
    }
  }
  const cv::Mat1b kernel = cv::Mat1b::ones(3, 3);
  cv::erode(low, low, kernel);
  cv::dilate(high, high, kernel);
  for (int y = 0; y < size.height; ++y) {
    const float *depth = frame.depth_m[y], *low_row = low[y / kHoleBlockCells], *high_row = high[y / kHoleBlockCells];
    for (int x = 0; x < size.width; ++x) {
      if (depth[x] > 0.0F) continue;
      const float nearest = low_row[x / kHoleBlockCells];
      frame.depth_low_m(y, x) = nearest < kFarM ? nearest : 0.0F;
      frame.depth_high_m(y, x) = high_row[x / kHoleBlockCells];
    }
  }
}

}  // namespace

WorkGrid::WorkGrid(std::shared_ptr<const CameraModel> camera, int flow_width_px)
    : camera_(std::move(camera)), size_(gridSize(*camera_, flow_width_px)) {
  const CameraIntrinsics& k = camera_->intrinsics();
  const double scale_x = static_cast<double>(size_.width) / k.width;
  const double scale_y = static_cast<double>(size_.height) / k.height;
  cell_px_ = static_cast<float>(1.0 / scale_x);
  fx_ = static_cast<float>(k.fx * scale_x);
  fy_ = static_cast<float>(k.fy * scale_y);
  cx_ = static_cast<float>((k.cx + 0.5) * scale_x - 0.5);
  cy_ = static_cast<float>((k.cy + 0.5) * scale_y - 0.5);
  for (std::size_t i = 0; i < k_.size(); ++i) k_[i] = static_cast<float>(k.distortion[i]);
  // At this reduction the linear filter takes the mean of the pixels about the cell's centre: the ray there.
  cv::resize(camera_->rays(), rays_, size_, 0, 0, cv::INTER_LINEAR);
  cv::extractChannel(rays_, rays_x_, 0);
  cv::extractChannel(rays_, rays_y_, 1);
}

void WorkGrid::projectRow(int row, const float* depth_m, const CellTransform& T, ProjectedRow& out) const {
  // Two simple loops without branches, so that the compiler takes four cells at a time.
  const int width = size_.width;
  const float *ray_x = rays_x_[row], *ray_y = rays_y_[row];
  const auto coordinate = [&](int axis, float* moved_m) {
    const float rx = T.R(axis, 0), ry = T.R(axis, 1), rz = T.R(axis, 2), t = T.t(axis);
    for (int i = 0; i < width; ++i) moved_m[i] = (rx * ray_x[i] + ry * ray_y[i] + rz) * depth_m[i] + t;
  };
  float *x = out.x.data(), *y = out.y.data(), *z = out.depth_m.data();
  coordinate(0, x);
  coordinate(1, y);
  coordinate(2, z);
  const std::array<float, 5> k = k_;
  const float fx = fx_, fy = fy_, cx = cx_, cy = cy_;
  constexpr float kNearestM = 1e-3F;
  for (int i = 0; i < width; ++i) {
    const float inverse_z = 1.0F / (z[i] > kNearestM ? z[i] : kNearestM);
    float a = x[i] * inverse_z, b = y[i] * inverse_z;
    distortPlumbBob(k, a, b);
    x[i] = fx * a + cx;
    y[i] = fy * b + cy;
  }
}

cv::Vec2f WorkGrid::rayAt(float x, float y) const {
  x = std::clamp(x, 0.0F, static_cast<float>(size_.width - 1));
  y = std::clamp(y, 0.0F, static_cast<float>(size_.height - 1));
  return sampleBilinear(rays_, x, y);
}

GridFrame makeGridFrame(const RgbdFrame& frame, const WorkGrid& grid) {
  GridFrame out;
  out.stamp = frame.stamp;
  cv::resize(frame.gray, out.gray, grid.flowSize(), 0, 0, cv::INTER_AREA);
  out.depth_m = sampleDepth(frame.depth_m, grid.size());
  cv::resize(out.gray, out.cell_gray, grid.size(), 0, 0, cv::INTER_AREA);
  out.texture = gradientMagnitude(out.cell_gray);
  const cv::Mat1b kernel = cv::Mat1b::ones(3, 3);
  cv::dilate(out.depth_m, out.depth_high_m, kernel);
  cv::Mat1f no_holes = out.depth_m.clone();
  no_holes.setTo(kFarM, no_holes <= 0.0F);
  cv::erode(no_holes, out.depth_low_m, kernel);
  fillHoles(out, no_holes);
  out.surface_m = out.depth_m.clone();
  out.depth_high_m.copyTo(out.surface_m, out.depth_m <= 0.0F);
  return out;
}

}  // namespace semantic_vslam
