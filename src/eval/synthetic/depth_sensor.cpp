// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "eval/synthetic/depth_sensor.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "core/camera/depth_quantum.h"
#include "core/common/rng.h"

namespace semantic_vslam::synthetic {
namespace {

/// Normal draws at a few ns each: a long table, entered at places that a SplitMix64 generator picks.
class FastNoise {
 public:
  explicit FastNoise(std::uint64_t seed) : state_(seed) {}
  std::uint64_t bits() {
    std::uint64_t z = (state_ += 0x9E3779B97F4A7C15ULL);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
    return z ^ (z >> 31);
  }
  /// Four independent standard normal values.
  cv::Vec4f normals() {
    const std::vector<float>& t = table();
    const std::uint64_t b = bits();
    return {t[b & 0xFFFF], t[(b >> 16) & 0xFFFF], t[(b >> 32) & 0xFFFF], t[b >> 48]};
  }

 private:
  static const std::vector<float>& table() {
    static const std::vector<float> values = [] {
      std::vector<float> drawn(1 << 16);
      Rng rng(20231);
      for (float& value : drawn) value = static_cast<float>(rng.normal());
      return drawn;
    }();
    return values;
  }
  std::uint64_t state_;
};

/// Removes what the projector, baseline_m to the right of the camera, does not reach.
void cutProjectorShadow(cv::Mat1f& depth_m, double focal_px, double baseline_m) {
  const auto shift = static_cast<float>(focal_px * baseline_m);
  constexpr float kTolerancePx = 1.5F;  // a slanted surface does not shade itself
  for (int v = 0; v < depth_m.rows; ++v) {
    float* row = depth_m.ptr<float>(v);
    float leftmost = std::numeric_limits<float>::max();  // column in the projector's image, of all to the right
    for (int u = depth_m.cols - 1; u >= 0; --u) {
      if (row[u] <= 0.0F) continue;
      const float column = static_cast<float>(u) - shift / row[u];
      if (column > leftmost + kTolerancePx) row[u] = 0.0F;
      leftmost = std::min(leftmost, column);
    }
  }
}

}  // namespace

cv::Mat1f senseDepth(const cv::Mat1f& true_depth_m, double focal_px, const SensorModel& model, std::uint64_t seed) {
  cv::Mat1f visible_m = true_depth_m.clone();
  if (model.depth_holes) cutProjectorShadow(visible_m, focal_px, model.baseline_m);
  FastNoise noise(seed);
  const auto dropout = static_cast<std::uint64_t>(model.dropout_share * 65536.0);
  cv::Mat1f sensed_m(visible_m.size(), 0.0F);
  for (int v = 0; v < visible_m.rows; ++v) {
    for (int u = 0; u < visible_m.cols; ++u) {
      const cv::Vec4f normal = noise.normals();
      const bool dropped = model.depth_holes && (noise.bits() & 0xFFFF) < dropout;
      const double jitter_px = model.depth_noise ? model.edge_jitter_px : 0.0;
      const int from_u = std::clamp(cvRound(u + jitter_px * normal[0]), 0, visible_m.cols - 1);
      const int from_v = std::clamp(cvRound(v + jitter_px * normal[1]), 0, visible_m.rows - 1);
      double z = visible_m(from_v, from_u);
      if (z <= 0.0 || visible_m(v, u) <= 0.0F || dropped) continue;
      if (model.depth_noise) {
        z = std::max(z + kinectSigma(z) * normal[2], 0.05);
        z = 1.0 / (std::round(1.0 / (z * kKinectStepPerM2)) * kKinectStepPerM2);
      }
      if (model.depth_range && (z < model.min_depth_m || z > model.max_depth_m)) continue;
      sensed_m(v, u) = static_cast<float>(z);
    }
  }
  return sensed_m;
}

cv::Mat3b senseColor(const cv::Mat3b& true_bgr, const SensorModel& model, std::uint64_t seed) {
  cv::Mat3b sensed = true_bgr.clone();
  if (model.blur_px > 0.0) cv::GaussianBlur(true_bgr, sensed, {5, 5}, model.blur_px);
  if (model.color_noise <= 0.0) return sensed;
  FastNoise noise(seed);
  const auto sigma = static_cast<float>(model.color_noise);
  for (cv::Vec3b& pixel : sensed) {
    const cv::Vec4f normal = noise.normals();
    for (int c = 0; c < 3; ++c) {
      // Half of the noise is common to the channels, as after demosaicing.
      pixel[c] = cv::saturate_cast<std::uint8_t>(pixel[c] + sigma * (0.7F * normal[3] + 0.7F * normal[c]));
    }
  }
  return sensed;
}

}  // namespace semantic_vslam::synthetic
