// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/motion/rigid_flow.h"

#include <cmath>
#include <limits>
#include <opencv2/core/hal/intrin.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace semantic_vslam {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
// Depth noise allowed to each side, in standard deviations.
constexpr float kDepthSigmas = 2.0F;
// Range of a depth camera: what a hole without surroundings may hide, metres.
constexpr float kHoleNearM = 0.4F, kHoleFarM = 12.0F;
// Nearer than any depth camera reads.
constexpr float kNearestM = 0.1F;
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
  float *nearest = near_m.data(), *farthest = far_m.data();
  const RigidFlowConfig noise = config;  // nothing that is written to below
  for (int x = 0; x < frame.depth_m.cols; ++x) {
    const bool known = (low[x] > 0.0F) & (high[x] > 0.0F);
    const float near_known = std::max(kNearestM, low[x] - kDepthSigmas * depthSigma(noise, low[x]));
    const float far_known = high[x] + kDepthSigmas * depthSigma(noise, high[x]);
    nearest[x] = known ? near_known : kHoleNearM;
    farthest[x] = known ? far_known : kHoleFarM;
  }
}

/// True if, standing still, even the nearest depth the cell may have was behind what the previous frame saw there.
bool wasHidden(const GridFrame& previous, const cv::Vec2f& cell, float depth_m, const RigidFlowConfig& config) {
  const int x = static_cast<int>(cell[0] + 0.5F), y = static_cast<int>(cell[1] + 0.5F);
  if (x < 0 || y < 0 || x >= previous.depth_m.cols || y >= previous.depth_m.rows) return false;
  const float before = previous.depth_low_m(y, x);
  return before > 0.0F && depth_m - before > kHiddenMarginM + kDepthSigmas * depthSigma(config, depth_m);
}

/// What flow may differ by without motion, standard deviations in px of the full image.
struct Spread {
  Spread(const CameraMotion& motion, const WorkGrid& grid) {
    const float focal_px = grid.focalCells() * grid.cellPx();
    const float rotation_px = static_cast<float>(motion.rotation_sigma_rad) * focal_px;
    const auto flow_px = static_cast<float>(motion.flow_sigma_px);
    translation_px_m = static_cast<float>(motion.translation_sigma_m) * focal_px;
    fixed_variance_px2 = flow_px * flow_px + rotation_px * rotation_px;
  }
  float translation_px_m;  ///< at 1 m; falls with depth
  float fixed_variance_px2;
};

/// Distance of four cells' measured flow from the pieces of epipolar line between two projections each.
void compareFour(int x, const float* flow, float row, const ProjectedRow& nearest, const ProjectedRow& farthest,
                 const float* near_m, const WorkGrid& grid, const Spread& spread, float* predicted, float* amplitude_px,
                 float* sigmas) {
  using cv::v_float32x4, cv::v_load, cv::v_max, cv::v_min, cv::v_setall_f32;
  const v_float32x4 zero = v_setall_f32(0.0F), point = v_setall_f32(1e-8F);  // below 1e-4 cells all is the closest
  const v_float32x4 right = v_setall_f32(static_cast<float>(grid.size().width - 1)),
                    bottom = v_setall_f32(static_cast<float>(grid.size().height - 1));
  v_float32x4 flow_x, flow_y;
  cv::v_load_deinterleave(flow + 2 * x, flow_x, flow_y);
  const auto column = static_cast<float>(x);
  const v_float32x4 measured_x = v_float32x4(column, column + 1, column + 2, column + 3) - flow_x,
                    measured_y = v_setall_f32(row) - flow_y;
  const v_float32x4 from_x = v_load(&nearest.x[x]), from_y = v_load(&nearest.y[x]);
  const v_float32x4 along_x = v_load(&farthest.x[x]) - from_x, along_y = v_load(&farthest.y[x]) - from_y;
  const v_float32x4 projected = (measured_x - from_x) * along_x + (measured_y - from_y) * along_y;
  const v_float32x4 share =
      v_min(v_max(projected / v_max(along_x * along_x + along_y * along_y, point), zero), v_setall_f32(1.0F));
  const v_float32x4 predicted_x = from_x + along_x * share, predicted_y = from_y + along_y * share;
  cv::v_store_interleave(predicted + 2 * x, predicted_x, predicted_y);
  const v_float32x4 dx = measured_x - predicted_x, dy = measured_y - predicted_y;
  const v_float32x4 inside =
      (measured_x >= zero) & (measured_y >= zero) & (measured_x <= right) & (measured_y <= bottom);
  const v_float32x4 distance = cv::v_sqrt(dx * dx + dy * dy) * v_setall_f32(grid.cellPx());  // eq. (1)
  const v_float32x4 amplitude = cv::v_select(inside, distance, v_setall_f32(kNan));
  const v_float32x4 shift = v_setall_f32(spread.translation_px_m) / v_load(near_m + x);
  cv::v_store(amplitude_px + x, amplitude);
  cv::v_store(sigmas + x, amplitude / cv::v_sqrt(v_setall_f32(spread.fixed_variance_px2) + shift * shift));
}

void compareRow(const cv::Mat2f& flow_cells, int y, const ProjectedRow& nearest, const ProjectedRow& farthest,
                const std::vector<float>& near_m, const WorkGrid& grid, const Spread& spread, RigidFlowResidual& out) {
  const int last = grid.size().width - 4;  // the last four may overlap those before them; a grid has 8 cells at least
  for (int x = 0; x < last + 4; x += 4) {
    compareFour(std::min(x, last), flow_cells.ptr<float>(y), static_cast<float>(y), nearest, farthest, near_m.data(),
                grid, spread, out.previous.ptr<float>(y), out.amplitude_px[y], out.sigmas[y]);
  }
}

/// Bilinear sample of an 8-bit image; positions outside are clamped.
inline float sampleGray(const cv::Mat1b& gray, float x, float y) {
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
  const Spread spread(motion, grid);
  std::vector<float> near_m(size.width), far_m(size.width);
  ProjectedRow nearest(size.width), farthest(size.width);
  for (int y = 0; y < size.height; ++y) {
    plausibleDepths(current, config, y, near_m, far_m);
    grid.projectRow(y, near_m.data(), T_previous_current, nearest);
    grid.projectRow(y, far_m.data(), T_previous_current, farthest);
    compareRow(flow_cells, y, nearest, farthest, near_m, grid, spread, out);
    const cv::Vec2f* source = out.previous[y];
    uchar* hidden = out.hidden[y];
    for (int x = 0; x < size.width; ++x) {
      hidden[x] = wasHidden(previous, source[x], nearest.depth_m[x], config) ? 255 : 0;
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
      const auto here = static_cast<float>(current.cell_gray(y, x));
      const float by_rigid = sampleGray(previous.gray, toGray(rigid[x][0]), toGray(rigid[x][1]));
      const float by_flow = sampleGray(previous.gray, toGray(column - flow[x][0]), toGray(row - flow[x][1]));
      gain(y, x) = std::abs(here - by_rigid) - std::abs(here - by_flow);
    }
  }
  cv::boxFilter(gain, gain, -1, {3, 3});
  changeCells(gain, [](float value) { return std::min(std::max(value * (1.0F / kFullGain), -1.0F), 1.0F); });
  return gain;
}

}  // namespace semantic_vslam
