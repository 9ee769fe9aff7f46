// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "semantic_vslam/core/motion/work_grid.h"

#include <cmath>
#include <opencv2/imgproc.hpp>

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
  for (int y = 0; y < size.height; ++y) {
    const int top = static_cast<int>((static_cast<float>(y) + 0.25F) * step_y);
    const int bottom = std::min(static_cast<int>((static_cast<float>(y) + 0.75F) * step_y), depth_m.rows - 1);
    const float* rows[2] = {depth_m[top], depth_m[bottom]};
    float* out = sampled[y];
    for (int x = 0; x < size.width; ++x) {
      const int left = static_cast<int>((static_cast<float>(x) + 0.25F) * step_x);
      const int right = std::min(static_cast<int>((static_cast<float>(x) + 0.75F) * step_x), depth_m.cols - 1);
      const float candidates[4] = {rows[1][right], rows[0][left], rows[0][right], rows[1][left]};
      out[x] = 0.0F;
      for (const float z : candidates) {
        if (z > 0.0F) {
          out[x] = z;
          break;
        }
      }
    }
  }
  return sampled;
}

cv::Mat1f gradientMagnitude(const cv::Mat1b& gray, cv::Size size) {
  cv::Mat1b small;
  cv::resize(gray, small, size, 0, 0, cv::INTER_AREA);
  cv::Mat1f magnitude(size, 0.0F);
  for (int y = 1; y + 1 < size.height; ++y) {
    const uchar *above = small[y - 1], *here = small[y], *below = small[y + 1];
    float* out = magnitude[y];
    for (int x = 1; x + 1 < size.width; ++x) {
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
void fillHoles(GridFrame& frame) {
  const cv::Size size = frame.depth_m.size();
  const cv::Size blocks((size.width + kHoleBlockCells - 1) / kHoleBlockCells,
                        (size.height + kHoleBlockCells - 1) / kHoleBlockCells);
  cv::Mat1f low(blocks, kFarM), high(blocks, 0.0F);
  for (int y = 0; y < size.height; ++y) {
    const float* depth = frame.depth_m[y];
    float *low_row = low[y / kHoleBlockCells], *high_row = high[y / kHoleBlockCells];
    for (int x = 0; x < size.width; ++x) {
      if (depth[x] <= 0.0F) continue;
      low_row[x / kHoleBlockCells] = std::min(low_row[x / kHoleBlockCells], depth[x]);
      high_row[x / kHoleBlockCells] = std::max(high_row[x / kHoleBlockCells], depth[x]);
    }
  }
  const cv::Mat1b kernel = cv::Mat1b::ones(3, 3);
  cv::erode(low, low, kernel);
  cv::dilate(high, high, kernel);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      if (frame.depth_m(y, x) > 0.0F) continue;
      const float nearest = low(y / kHoleBlockCells, x / kHoleBlockCells);
      frame.depth_low_m(y, x) = nearest < kFarM ? nearest : 0.0F;
      frame.depth_high_m(y, x) = high(y / kHoleBlockCells, x / kHoleBlockCells);
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
  const auto [k1, k2, p1, p2, k3] = k_;
  const float fx = fx_, fy = fy_, cx = cx_, cy = cy_;
  constexpr float kNearestM = 1e-3F;
  for (int i = 0; i < width; ++i) {
    const float inverse_z = 1.0F / (z[i] > kNearestM ? z[i] : kNearestM);
    const float a = x[i] * inverse_z, b = y[i] * inverse_z;
    const float r2 = a * a + b * b;
    const float radial = 1.0F + r2 * (k1 + r2 * (k2 + r2 * k3));
    x[i] = fx * (a * radial + 2.0F * p1 * a * b + p2 * (r2 + 2.0F * a * a)) + cx;
    y[i] = fy * (b * radial + p1 * (r2 + 2.0F * b * b) + 2.0F * p2 * a * b) + cy;
  }
}

cv::Vec2f WorkGrid::rayAt(float x, float y) const {
  x = std::clamp(x, 0.0F, static_cast<float>(size_.width - 1));
  y = std::clamp(y, 0.0F, static_cast<float>(size_.height - 1));
  const int x0 = std::min(static_cast<int>(x), size_.width - 2), y0 = std::min(static_cast<int>(y), size_.height - 2);
  const float dx = x - static_cast<float>(x0), dy = y - static_cast<float>(y0);
  const cv::Vec2f *top = rays_[y0] + x0, *bottom = rays_[y0 + 1] + x0;
  return (top[0] * (1 - dx) + top[1] * dx) * (1 - dy) + (bottom[0] * (1 - dx) + bottom[1] * dx) * dy;
}

GridFrame makeGridFrame(const RgbdFrame& frame, const WorkGrid& grid) {
  GridFrame out;
  out.stamp = frame.stamp;
  cv::resize(frame.gray, out.gray, grid.flowSize(), 0, 0, cv::INTER_AREA);
  out.depth_m = sampleDepth(frame.depth_m, grid.size());
  out.texture = gradientMagnitude(out.gray, grid.size());
  const cv::Mat1b kernel = cv::Mat1b::ones(3, 3);
  cv::dilate(out.depth_m, out.depth_high_m, kernel);
  cv::Mat1f no_holes = out.depth_m.clone();
  for (float& z : no_holes) z = z > 0.0F ? z : kFarM;
  cv::erode(no_holes, out.depth_low_m, kernel);
  fillHoles(out);
  return out;
}

}  // namespace semantic_vslam
