// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/motion/flow_colour.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace semantic_vslam {
namespace {

// The five principal and five intermediate hues of Munsell's circle at value 5 and high chroma, in sRGB, as BGR.
constexpr std::array<std::array<float, 3>, 10> kHues = {{
    {60, 40, 215},   // R
    {20, 115, 235},  // YR
    {20, 205, 240},  // Y
    {40, 190, 150},  // GY
    {85, 155, 20},   // G
    {150, 150, 0},   // BG
    {205, 140, 0},   // B
    {215, 85, 60},   // PB
    {200, 60, 140},  // P
    {140, 40, 205},  // RP
}};

float automaticScale(const cv::Mat2f& flow) {
  std::vector<float> amplitudes;
  amplitudes.reserve(flow.total());
  for (const cv::Vec2f& f : flow) {
    const float amplitude = std::hypot(f[0], f[1]);
    if (std::isfinite(amplitude)) amplitudes.push_back(amplitude);
  }
  if (amplitudes.empty()) return 1.0F;
  const auto nth = amplitudes.begin() + static_cast<std::ptrdiff_t>(amplitudes.size() * 99 / 100);
  std::nth_element(amplitudes.begin(), nth, amplitudes.end());
  return std::max(1.0F, *nth);
}

cv::Vec3b colourOf(const cv::Vec2f& flow, float scale) {
  const float amplitude = std::hypot(flow[0], flow[1]);
  if (!std::isfinite(amplitude)) return {0, 0, 0};
  constexpr auto kTwoPi = static_cast<float>(2.0 * CV_PI);
  float turn = std::atan2(flow[1], flow[0]) / kTwoPi;  // 0 = to the right
  if (turn < 0.0F) turn += 1.0F;
  const float position = turn * static_cast<float>(kHues.size());
  const auto first = static_cast<std::size_t>(position) % kHues.size();
  const std::size_t second = (first + 1) % kHues.size();
  const float blend = position - std::floor(position);
  const float saturation = std::min(1.0F, amplitude / scale);
  cv::Vec3b colour;
  for (int c = 0; c < 3; ++c) {
    const auto channel = static_cast<std::size_t>(c);
    const float hue = kHues[first][channel] * (1.0F - blend) + kHues[second][channel] * blend;
    colour[c] = cv::saturate_cast<uchar>(255.0F + saturation * (hue - 255.0F));
  }
  return colour;
}

}  // namespace

cv::Mat3b flowPicture(const cv::Mat2f& flow_px, double full_scale_px) {
  const float scale = full_scale_px > 0.0 ? static_cast<float>(full_scale_px) : automaticScale(flow_px);
  cv::Mat3b picture(flow_px.size());
  std::transform(flow_px.begin(), flow_px.end(), picture.begin(),
                 [scale](const cv::Vec2f& flow) { return colourOf(flow, scale); });
  return picture;
}

}  // namespace semantic_vslam
