// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "eval/synthetic/pattern_tools.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "eval/synthetic/patterns.h"

namespace semantic_vslam::synthetic {

int pick(Rng& rng, int low, int high) { return low + static_cast<int>(rng.below(high - low + 1)); }

cv::Mat3b toned(const cv::Scalar& color, const cv::Mat1f& pattern, float contrast, float speckle, Rng& rng) {
  cv::Mat3b image(pattern.size());
  std::uint64_t state = rng.below(1ULL << 62);  // a linear congruential generator is good enough for grain, and fast
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      state = state * 6364136223846793005ULL + 1442695040888963407ULL;
      const float grain = speckle * (static_cast<float>(state >> 40) * 0x1.0p-23F - 1.0F);
      const float factor = 1.0F + contrast * pattern(y, x) + grain;
      for (int c = 0; c < 3; ++c) image(y, x)[c] = cv::saturate_cast<std::uint8_t>(color[c] * factor);
    }
  }
  return image;
}

void weather(cv::Mat3b& image, float contrast, Rng& rng) {
  const cv::Mat1f noise = fractalNoise(image.size(), 3, 3, 6, 0.65F, rng);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const float factor = 1.0F + contrast * noise(y, x);
      for (int c = 0; c < 3; ++c) image(y, x)[c] = cv::saturate_cast<std::uint8_t>(image(y, x)[c] * factor);
    }
  }
}

std::string randomWord(Rng& rng, int low, int high) {
  static const std::string letters = "aabcdeeefghiijklmnooprrssttuuvwxyzABCDEGHKMNPRST0123456789";
  std::string word;
  for (int i = pick(rng, low, high); i > 0; --i) word += letters[rng.below(letters.size())];
  return word;
}

void drawWord(cv::Mat3b& image, const std::string& word, cv::Point at, double height_px, const cv::Scalar& color,
              Rng& rng) {
  static const int fonts[] = {cv::FONT_HERSHEY_SIMPLEX, cv::FONT_HERSHEY_DUPLEX, cv::FONT_HERSHEY_COMPLEX,
                              cv::FONT_HERSHEY_TRIPLEX};
  const int thickness = std::max(1, static_cast<int>(height_px / 9.0) + pick(rng, 0, 1));
  cv::putText(image, word, at, fonts[rng.below(4)], height_px / 22.0, color, thickness, cv::LINE_AA);
}

void drawParagraph(cv::Mat3b& image, const cv::Rect& area, double height_px, const cv::Scalar& color, Rng& rng) {
  const double line_px = 1.6 * height_px;
  for (double y = area.y + line_px; y < area.y + area.height; y += line_px) {
    double x = area.x;
    while (x < area.x + area.width * rng.uniform(0.8, 1.0)) {
      const std::string word = randomWord(rng, 2, 8);
      const double width_px = 0.85 * height_px * static_cast<double>(word.size());
      if (x + width_px > area.x + area.width) break;
      drawWord(image, word, {static_cast<int>(x), static_cast<int>(y)}, height_px, color, rng);
      x += width_px + 0.7 * height_px;
    }
  }
}

void drawShape(cv::Mat3b& image, const cv::Point& center, int radius, const cv::Scalar& color, Rng& rng) {
  switch (rng.below(4)) {
    case 0: cv::circle(image, center, radius, color, cv::FILLED, cv::LINE_AA); break;
    case 1: cv::circle(image, center, radius, color, std::max(2, radius / 4), cv::LINE_AA); break;
    case 2: {
      const cv::RotatedRect box(center, cv::Size2f(1.8F * radius, radius * static_cast<float>(rng.uniform(0.5, 1.8))),
                                static_cast<float>(rng.uniform(0, 90)));
      cv::Point2f corners[4];
      box.points(corners);
      std::vector<cv::Point> polygon(corners, corners + 4);
      cv::fillConvexPoly(image, polygon, color, cv::LINE_AA);
      break;
    }
    default: {
      std::vector<cv::Point> star;
      const int points = pick(rng, 3, 7);
      for (int i = 0; i < 2 * points; ++i) {
        const double angle = M_PI * i / points, r = (i & 1) ? 0.45 * radius : radius;
        star.emplace_back(center.x + cvRound(r * std::cos(angle)), center.y + cvRound(r * std::sin(angle)));
      }
      cv::fillPoly(image, std::vector<std::vector<cv::Point>>{star}, color, cv::LINE_AA);
    }
  }
}

cv::Scalar darker(const cv::Scalar& color, double factor) {
  return {color[0] * factor, color[1] * factor, color[2] * factor};
}

cv::Scalar contrasting(const cv::Scalar& color, Rng& rng) {
  const double brightness = 0.114 * color[0] + 0.587 * color[1] + 0.299 * color[2];
  return brightness > 120 ? randomColor(rng, 60, 220, 20, 90) : randomColor(rng, 0, 140, 190, 250);
}

void drawWrapped(cv::Mat3b& image, const std::function<void(cv::Mat3b&, cv::Point)>& draw) {
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) draw(image, {dx * image.cols, dy * image.rows});
  }
}

cv::Mat1f woodGrain(const cv::Size& size, Rng& rng) {
  cv::Mat1f grain = fractalNoise(size, 2, 24, 5, 0.75F, rng);
  const cv::Mat1f bend = fractalNoise(size, 2, 6, 2, 0.5F, rng);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) grain(y, x) = 0.6F * grain(y, x) + 0.7F * std::sin(7.0F * bend(y, x));
  }
  return grain;
}

cv::Scalar randomColor(Rng& rng, double saturation_low, double saturation_high, double value_low, double value_high) {
  const cv::Mat3b hsv(1, 1,
                      cv::Vec3b(cv::saturate_cast<std::uint8_t>(rng.uniform(0, 180)),
                                cv::saturate_cast<std::uint8_t>(rng.uniform(saturation_low, saturation_high)),
                                cv::saturate_cast<std::uint8_t>(rng.uniform(value_low, value_high))));
  cv::Mat3b bgr;
  cv::cvtColor(hsv, bgr, cv::COLOR_HSV2BGR);
  return {static_cast<double>(bgr(0)[0]), static_cast<double>(bgr(0)[1]), static_cast<double>(bgr(0)[2])};
}

cv::Scalar colorFrom(const std::vector<cv::Scalar>& palette, Rng& rng) {
  cv::Scalar color = palette[rng.below(palette.size())] * rng.uniform(0.88, 1.1);
  for (int c = 0; c < 3; ++c) color[c] = std::min(250.0, color[c] * rng.uniform(0.94, 1.06));
  return color;
}

cv::Mat1f fractalNoise(const cv::Size& size, int cells_x, int cells_y, int octaves, float gain, Rng& rng) {
  constexpr int kMargin = 2;  // cells, enough for cubic interpolation across the seam
  cv::Mat1f sum(size, 0.0F);
  float amplitude = 1.0F;
  for (int i = 0; i < octaves && cells_x <= size.width && cells_y <= size.height; ++i) {
    cv::Mat1f cells(cells_y, cells_x), wrapped, smooth;
    for (float& cell : cells) cell = static_cast<float>(rng.uniform(-1, 1));
    cv::copyMakeBorder(cells, wrapped, kMargin, kMargin, kMargin, kMargin, cv::BORDER_WRAP);
    const int per_cell_x = size.width / cells_x + 1, per_cell_y = size.height / cells_y + 1;
    cv::resize(wrapped, smooth, {}, per_cell_x, per_cell_y, cv::INTER_CUBIC);
    cv::Mat1f octave(smooth,
                     cv::Rect(kMargin * per_cell_x, kMargin * per_cell_y, cells_x * per_cell_x, cells_y * per_cell_y));
    cv::resize(octave, octave, size, 0, 0, cv::INTER_LINEAR);
    sum += amplitude * octave;
    amplitude *= gain;
    cells_x *= 2;
    cells_y *= 2;
  }
  cv::Scalar mean, deviation;
  cv::meanStdDev(sum, mean, deviation);
  return cv::Mat1f((sum - mean[0]) / std::max(deviation[0], 1e-6));
}

}  // namespace semantic_vslam::synthetic
