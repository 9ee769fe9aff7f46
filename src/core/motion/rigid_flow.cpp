// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "semantic_vslam/core/motion/rigid_flow.h"

#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace semantic_vslam {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
// Depth noise allowed to each side, in standard deviations.
constexpr float kDepthSigmas = 2.0F;
// Range of a depth camera: what a hole without surroundings may hide, metres.
constexpr float kHoleNearM = 0.4F, kHoleFarM = 12.0F;
// A surface counts as hidden before if it lies behind what was seen by this and the noise, metres.
constexpr float kHiddenMarginM = 0.03F;
// Residuals below this many standard deviations are the flow's own noise: their brightness need not be compared.
constexpr float kNoiseSigmas = 1.5F;
// Gain in brightness error at which the measured flow is believed fully, gray levels (image noise is 2 to 4).
constexpr float kFullGain = 6.0F;

/// Nearest and farthest depth that each cell of a row may have.
void plausibleDepths(const GridFrame& frame, const RigidFlowConfig& config, int y, std::vector<float>& near_m,
                     std::vector<float>& far_m) {
  const float *low = frame.depth_low_m[y], *high = frame.depth_high_m[y];
  for (int x = 0; x < frame.depth_m.cols; ++x) {
    const bool known = low[x] > 0.0F && high[x] > 0.0F;
    const float nearest = std::max(0.1F, low[x] - kDepthSigmas * depthSigma(config, low[x]));
    const float farthest = high[x] + kDepthSigmas * depthSigma(config, high[x]);
    near_m[x] = known ? nearest : kHoleNearM;
    far_m[x] = known ? farthest : kHoleFarM;
  }
}

cv::Point2f closestOnSegment(const cv::Point2f& a, const cv::Point2f& b, const cv::Point2f& p) {
  constexpr float kPoint = 1e-8F;  // shorter than 1e-4 cells: any of its points is the closest
  const cv::Point2f along = b - a;
  return a + along * std::clamp((p - a).dot(along) / std::max(along.dot(along), kPoint), 0.0F, 1.0F);
}

/// True if, standing still, even the nearest depth the cell may have was behind what the previous frame saw there.
bool wasHidden(const GridFrame& previous, const cv::Point2f& cell, float depth_m, const RigidFlowConfig& config) {
  const int x = static_cast<int>(cell.x + 0.5F), y = static_cast<int>(cell.y + 0.5F);
  if (x < 0 || y < 0 || x >= previous.depth_m.cols || y >= previous.depth_m.rows) return false;
  const float before = previous.depth_low_m(y, x);
  return before > 0.0F && depth_m - before > kHiddenMarginM + kDepthSigmas * depthSigma(config, depth_m);
}

/// Bilinear sample of an 8-bit image; positions outside are clamped.
float sampleGray(const cv::Mat1b& gray, float x, float y) {
  x = std::clamp(x, 0.0F, static_cast<float>(gray.cols) - 1.001F);
  y = std::clamp(y, 0.0F, static_cast<float>(gray.rows) - 1.001F);
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const float dx = x - static_cast<float>(x0), dy = y - static_cast<float>(y0);
  const uchar *top = gray[y0] + x0, *bottom = gray[y0 + 1] + x0;
  const float upper = static_cast<float>(top[0]) + dx * static_cast<float>(top[1] - top[0]);
  const float lower = static_cast<float>(bottom[0]) + dx * static_cast<float>(bottom[1] - bottom[0]);
  return upper + dy * (lower - upper);
}

}  // namespace

RigidFlowResidual computeRigidFlowResidual(const GridFrame& previous, const GridFrame& current,
                                           const cv::Mat2f& flow_cells, const CameraMotion& motion,
                                           const WorkGrid& grid, const RigidFlowConfig& config) {
  const cv::Size size = grid.size();
  RigidFlowResidual out{cv::Mat1f(size), cv::Mat1f(size), cv::Mat2f(size), cv::Mat1b(size)};
  const CellTransform T_previous_current(motion.T_previous_current);
  const float focal_px = grid.focalCells() * grid.cellPx();
  const auto sigma_t = static_cast<float>(motion.translation_sigma_m) * focal_px;
  const auto sigma_r = static_cast<float>(motion.rotation_sigma_rad) * focal_px;
  const auto flow_sigma = static_cast<float>(motion.flow_sigma_px);
  const float fixed_variance = flow_sigma * flow_sigma + sigma_r * sigma_r;
  std::vector<float> near_m(size.width), far_m(size.width);
  ProjectedRow nearest(size.width), farthest(size.width);
  for (int y = 0; y < size.height; ++y) {
    plausibleDepths(current, config, y, near_m, far_m);
    grid.projectRow(y, near_m.data(), T_previous_current, nearest);
    grid.projectRow(y, far_m.data(), T_previous_current, farthest);
    const cv::Vec2f* flow = flow_cells[y];
    float *amplitude_px = out.amplitude_px[y], *sigmas = out.sigmas[y];
    cv::Vec2f* source = out.previous[y];
    uchar* hidden = out.hidden[y];
    for (int x = 0; x < size.width; ++x) {
      const cv::Point2f measured(static_cast<float>(x) - flow[x][0], static_cast<float>(y) - flow[x][1]);
      const cv::Point2f predicted =
          closestOnSegment({nearest.x[x], nearest.y[x]}, {farthest.x[x], farthest.y[x]}, measured);
      source[x] = {predicted.x, predicted.y};
      hidden[x] = wasHidden(previous, predicted, nearest.depth_m[x], config) ? 255 : 0;
      if (!grid.contains(measured)) {
        amplitude_px[x] = sigmas[x] = kNan;
        continue;
      }
      const cv::Point2f difference = measured - predicted;
      const float shift = sigma_t / near_m[x];
      amplitude_px[x] = std::sqrt(difference.dot(difference)) * grid.cellPx();  // eq. (1)
      sigmas[x] = amplitude_px[x] / std::sqrt(fixed_variance + shift * shift);
    }
  }
  return out;
}

cv::Mat1f compareBrightness(const GridFrame& previous, const GridFrame& current, const cv::Mat2f& flow_cells,
                            const RigidFlowResidual& residual) {
  // A cell is two gray pixels wide: its centre lies between them.
  const auto toGray = [](float cell) { return 2.0F * cell + 0.5F; };
  cv::Mat1f gain(residual.sigmas.size(), 0.0F);
  for (int y = 0; y < gain.rows; ++y) {
    const float* sigmas = residual.sigmas[y];
    const uchar* hidden = residual.hidden[y];
    const cv::Vec2f *rigid = residual.previous[y], *flow = flow_cells[y];
    for (int x = 0; x < gain.cols; ++x) {
      if (!(sigmas[x] > kNoiseSigmas) || hidden[x]) continue;  // NaN too
      const auto column = static_cast<float>(x), row = static_cast<float>(y);
      const float here = sampleGray(current.gray, toGray(column), toGray(row));
      const float by_rigid = sampleGray(previous.gray, toGray(rigid[x][0]), toGray(rigid[x][1]));
      const float by_flow = sampleGray(previous.gray, toGray(column - flow[x][0]), toGray(row - flow[x][1]));
      gain(y, x) = std::abs(here - by_rigid) - std::abs(here - by_flow);
    }
  }
  cv::boxFilter(gain, gain, -1, {3, 3});
  for (float& value : gain) value = std::clamp(value / kFullGain, -1.0F, 1.0F);
  return gain;
}

}  // namespace semantic_vslam
