// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "semantic_vslam/core/motion/rigid_flow.h"

#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

namespace semantic_vslam {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
// Depth noise allowed to each side, in standard deviations.
constexpr float kDepthSigmas = 2.0F;
// Range of a depth camera: what a hole may hide, metres.
constexpr float kHoleNearM = 0.4F, kHoleFarM = 12.0F;
// Residuals below this many standard deviations are the flow's own noise: their brightness need not be compared.
constexpr float kNoiseSigmas = 1.5F;
// Gain in brightness error at which the measured flow is believed fully, gray levels (image noise is 2 to 4).
constexpr float kFullGain = 6.0F;

struct DepthRange {
  float low_m, high_m;
};

DepthRange plausibleDepth(const GridFrame& frame, const RigidFlowConfig& config, int y, int x) {
  const float low = frame.depth_low_m(y, x), high = frame.depth_high_m(y, x);
  if (frame.depth_m(y, x) <= 0.0F || low <= 0.0F) return {kHoleNearM, kHoleFarM};
  return {std::max(0.1F, low - kDepthSigmas * depthSigma(config, low)), high + kDepthSigmas * depthSigma(config, high)};
}

cv::Point2f closestOnSegment(const cv::Point2f& a, const cv::Point2f& b, const cv::Point2f& p) {
  const cv::Point2f along = b - a;
  const float length_squared = along.dot(along);
  if (length_squared < 1e-8F) return a;
  return a + along * std::clamp((p - a).dot(along) / length_squared, 0.0F, 1.0F);
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

RigidFlowResidual computeRigidFlowResidual(const GridFrame& current, const cv::Mat2f& flow_cells,
                                           const CameraMotion& motion, const WorkGrid& grid,
                                           const RigidFlowConfig& config) {
  const cv::Size size = grid.size();
  RigidFlowResidual out{cv::Mat1f(size), cv::Mat1f(size), cv::Mat2f(size)};
  const Eigen::Matrix3f R = motion.T_previous_current.linear().cast<float>();
  const Eigen::Vector3f t = motion.T_previous_current.translation().cast<float>();
  const float focal_px = grid.focalCells() * grid.cellPx();
  const auto sigma_t = static_cast<float>(motion.translation_sigma_m) * focal_px;
  const auto sigma_r = static_cast<float>(motion.rotation_sigma_rad) * focal_px;
  const auto flow_sigma = static_cast<float>(motion.flow_sigma_px);
  const float fixed_variance = flow_sigma * flow_sigma + sigma_r * sigma_r;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const cv::Vec2f ray = grid.rays()(y, x);
      const DepthRange depth = plausibleDepth(current, config, y, x);
      const Eigen::Vector3f turned = R * Eigen::Vector3f(ray[0], ray[1], 1.0F);
      const cv::Point2f near_px = grid.project(turned * depth.low_m + t);
      const cv::Point2f far_px = grid.project(turned * depth.high_m + t);
      const cv::Vec2f flow = flow_cells(y, x);
      const cv::Point2f measured(static_cast<float>(x) - flow[0], static_cast<float>(y) - flow[1]);
      const cv::Point2f predicted = closestOnSegment(near_px, far_px, measured);
      out.previous(y, x) = {predicted.x, predicted.y};
      if (!grid.contains(measured)) {
        out.amplitude_px(y, x) = out.sigmas(y, x) = kNan;
        continue;
      }
      const cv::Point2f difference = measured - predicted;
      const float amplitude = std::sqrt(difference.dot(difference)) * grid.cellPx();  // eq. (1)
      const float shift = sigma_t / depth.low_m;
      out.amplitude_px(y, x) = amplitude;
      out.sigmas(y, x) = amplitude / std::sqrt(fixed_variance + shift * shift);
    }
  }
  return out;
}

cv::Mat1f compareBrightness(const GridFrame& previous, const GridFrame& current, const cv::Mat2f& flow_cells,
                            const RigidFlowResidual& residual) {
  cv::Mat1f gain(residual.sigmas.size(), 0.0F);
  for (int y = 0; y < gain.rows; ++y) {
    for (int x = 0; x < gain.cols; ++x) {
      if (!(residual.sigmas(y, x) > kNoiseSigmas)) continue;  // NaN too
      // A cell is two gray pixels wide: its centre lies between them.
      const auto toGray = [](float cell) { return 2.0F * cell + 0.5F; };
      const float here = sampleGray(current.gray, toGray(static_cast<float>(x)), toGray(static_cast<float>(y)));
      const cv::Vec2f rigid = residual.previous(y, x), flow = flow_cells(y, x);
      const float by_rigid = sampleGray(previous.gray, toGray(rigid[0]), toGray(rigid[1]));
      const float by_flow =
          sampleGray(previous.gray, toGray(static_cast<float>(x) - flow[0]), toGray(static_cast<float>(y) - flow[1]));
      gain(y, x) = std::abs(here - by_rigid) - std::abs(here - by_flow);
    }
  }
  cv::boxFilter(gain, gain, -1, {3, 3});
  for (float& value : gain) value = std::clamp(value / kFullGain, -1.0F, 1.0F);
  return gain;
}

}  // namespace semantic_vslam
