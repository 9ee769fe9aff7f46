// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "semantic_vslam/core/eval/synthetic/patterns.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

namespace semantic_vslam::synthetic {
namespace {

const cv::Scalar kWhite(245, 245, 245), kInk(40, 35, 35);

int pick(Rng& rng, int low, int high) { return low + static_cast<int>(rng.below(high - low + 1)); }

/// One colour times (1 + contrast * pattern), plus fine speckle.
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

/// Multiplies a picture by (1 + contrast * noise), so that prints look worn and lit rather than drawn.
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

/// Lines of words from the left margin to a ragged right one.
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

/// Draws something that may cross the border at all nine shifts, so that the texture still repeats.
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

}  // namespace

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

cv::Mat3b paintedWall(const cv::Scalar& color, Rng& rng) {
  cv::Mat3b image = toned(color, fractalNoise({512, 512}, 4, 4, 7, 0.75F, rng), 0.045F, 0.02F, rng);
  for (int i = 0; i < 60; ++i) {  // scuffs, filled nail holes, stains
    const cv::Point at(pick(rng, 0, 511), pick(rng, 0, 511));
    const cv::Point to = at + cv::Point(pick(rng, -14, 14), pick(rng, -14, 14));
    const cv::Scalar mark = darker(color, rng.uniform(0.6, 1.12));
    const bool dot = rng.below(2) == 0;
    const int width = pick(rng, 1, 3);
    drawWrapped(image, [&](cv::Mat3b& target, cv::Point shift) {
      if (dot)
        cv::circle(target, at + shift, width, mark, cv::FILLED, cv::LINE_AA);
      else
        cv::line(target, at + shift, to + shift, mark, width / 2 + 1, cv::LINE_AA);
    });
  }
  return image;
}

cv::Mat3b brickWall(const cv::Scalar& color, Rng& rng) {
  cv::Mat3b image = toned({150, 155, 160}, fractalNoise({512, 512}, 16, 16, 5, 0.8F, rng), 0.06F, 0.03F, rng);
  constexpr int kRows = 16, kColumns = 8, kHeight = 32, kWidth = 64;
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      const cv::Scalar tone = darker(color, rng.uniform(0.75, 1.2));
      cv::Mat3b brick = toned(tone, fractalNoise({64, 32}, 2, 2, 5, 0.8F, rng), 0.08F, 0.04F, rng);
      brick = brick(cv::Rect(0, 0, kWidth - 5, kHeight - 5)).clone();
      const int x0 = column * kWidth + (row & 1) * kWidth / 2;
      for (int y = 0; y < brick.rows; ++y) {
        for (int x = 0; x < brick.cols; ++x) image(row * kHeight + y + 2, (x0 + x + 2) & 511) = brick(y, x);
      }
    }
  }
  return image;
}

cv::Mat3b wallpaper(const cv::Scalar& color, Rng& rng) {
  cv::Mat3b image = toned(color, fractalNoise({512, 512}, 4, 4, 7, 0.7F, rng), 0.03F, 0.015F, rng);
  const cv::Scalar ornament = darker(color, rng.uniform(0.72, 0.88));
  const int step = 64 << rng.below(2);
  for (int y = step / 2; y < 512; y += step) {
    for (int x = step / 2 + ((y / step) & 1) * step / 2; x < 512 + step / 2; x += step) {
      const int radius = pick(rng, step / 6, step / 4);
      Rng same = rng;  // every shift must draw the same shape
      drawWrapped(image, [&](cv::Mat3b& target, cv::Point shift) {
        Rng copy = same;
        drawShape(target, cv::Point(x, y) + shift, radius, ornament, copy);
      });
      rng.below(7);
    }
  }
  return image;
}

cv::Mat3b woodFloor(const cv::Scalar& color, Rng& rng) {
  constexpr int kPlanks = 8, kHeight = 64;
  cv::Mat3b image(512, 512);
  for (int row = 0; row < kPlanks; ++row) {
    const int joint = pick(rng, 0, 511);
    for (int half = 0; half < 2; ++half) {
      const cv::Scalar tone = darker(color, rng.uniform(0.72, 1.15));
      const cv::Mat3b plank = toned(tone, woodGrain({256, kHeight}, rng), 0.085F, 0.02F, rng);
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < 256; ++x) {
          const bool gap = y < 2 || x < 2;
          const cv::Vec3b pixel = gap ? cv::Vec3b(plank(y, x) * 0.35) : plank(y, x);
          image(row * kHeight + y, (joint + half * 256 + x) & 511) = pixel;
        }
      }
    }
  }
  return image;
}

cv::Mat3b carpet(const cv::Scalar& color, Rng& rng) {
  cv::Mat3b image = toned(color, fractalNoise({512, 512}, 6, 6, 7, 0.95F, rng), 0.10F, 0.12F, rng);
  for (int i = 0; i < 500; ++i) {
    const cv::Point at(pick(rng, 0, 511), pick(rng, 0, 511));
    const cv::Scalar tuft = darker(color, rng.uniform(0.45, 1.5));
    const int radius = pick(rng, 1, 4);
    drawWrapped(image, [&](cv::Mat3b& target, cv::Point shift) {
      cv::circle(target, at + shift, radius, tuft, cv::FILLED, cv::LINE_AA);
    });
  }
  return image;
}

cv::Mat3b floorTiles(const cv::Scalar& color, Rng& rng) {
  cv::Mat3b image(512, 512);
  constexpr int kTile = 128;
  for (int y0 = 0; y0 < 512; y0 += kTile) {
    for (int x0 = 0; x0 < 512; x0 += kTile) {
      const cv::Scalar tone = darker(color, rng.uniform(0.82, 1.08));
      cv::Mat3b tile = toned(tone, fractalNoise({kTile, kTile}, 3, 3, 6, 0.7F, rng), 0.07F, 0.03F, rng);
      cv::rectangle(tile, {0, 0}, {kTile - 1, kTile - 1}, darker(color, 0.5), 3);
      tile.copyTo(image(cv::Rect(x0, y0, kTile, kTile)));
    }
  }
  return image;
}

cv::Mat3b ceilingPanels(Rng& rng) {
  cv::Mat3b image = toned({225, 228, 230}, fractalNoise({512, 512}, 8, 8, 6, 0.8F, rng), 0.02F, 0.015F, rng);
  for (int i = 0; i < 900; ++i) {
    cv::circle(image, {pick(rng, 4, 507), pick(rng, 4, 507)}, pick(rng, 1, 2), {170, 172, 175}, cv::FILLED,
               cv::LINE_AA);
  }
  for (int at = 0; at < 512; at += 256) {
    cv::line(image, {at, 0}, {at, 511}, {150, 150, 152}, 5);
    cv::line(image, {0, at}, {511, at}, {150, 150, 152}, 5);
  }
  return image;
}

cv::Mat3b wood(const cv::Scalar& color, Rng& rng) {
  cv::Mat3b image = toned(color, woodGrain({512, 256}, rng), 0.09F, 0.02F, rng);
  for (int i = 0; i < 25; ++i) {  // stains, scratches and knots
    const cv::Point at(pick(rng, 0, 511), pick(rng, 0, 255));
    const cv::Scalar mark = darker(color, rng.uniform(0.5, 1.25));
    if (rng.below(3) == 0)
      cv::ellipse(image, at, {pick(rng, 2, 7), pick(rng, 1, 4)}, 0, 0, 360, mark, -1, cv::LINE_AA);
    else
      cv::line(image, at, at + cv::Point(pick(rng, -25, 25), pick(rng, -5, 5)), mark, 1, cv::LINE_AA);
  }
  return image;
}

cv::Mat3b plastic(const cv::Scalar& color, Rng& rng) {
  return toned(color, fractalNoise({64, 64}, 4, 4, 5, 0.8F, rng), 0.04F, 0.03F, rng);
}

cv::Mat3b leaf(Rng& rng) {
  const cv::Scalar color(rng.uniform(30, 60), rng.uniform(95, 150), rng.uniform(40, 90));
  cv::Mat3b image = toned(color, fractalNoise({128, 128}, 3, 6, 5, 0.8F, rng), 0.15F, 0.05F, rng);
  for (int x = 8; x < 128; x += 24) cv::line(image, {x, 0}, {x, 127}, darker(color, 1.35), 2, cv::LINE_AA);
  return image;
}

cv::Mat3b soil(Rng& rng) { return toned({40, 55, 75}, fractalNoise({64, 64}, 8, 8, 4, 0.9F, rng), 0.3F, 0.15F, rng); }

cv::Mat3b plainCloth(const cv::Scalar& color, Rng& rng) {
  // Long vertical cells: folds.
  cv::Mat1f folds = fractalNoise({256, 256}, 6, 3, 5, 0.65F, rng);
  return toned(color, folds, 0.13F, 0.05F, rng);
}

cv::Mat3b denim(const cv::Scalar& color, Rng& rng) {
  cv::Mat3b image = toned(color, fractalNoise({256, 256}, 5, 3, 6, 0.75F, rng), 0.15F, 0.12F, rng);
  cv::line(image, {0, 0}, {0, 255}, darker(color, 0.6), 3);
  cv::line(image, {6, 0}, {6, 255}, {60, 120, 170}, 1, cv::LINE_AA);
  return image;
}

cv::Mat3b plaid(const cv::Scalar& color, Rng& rng) {
  cv::Mat3b image = plainCloth(color, rng);
  const cv::Scalar bands[] = {darker(color, 0.45), randomColor(rng, 80, 220, 60, 230), kWhite};
  const int period = 64 << rng.below(2);
  for (int pass = 0; pass < 2; ++pass) {
    for (int at = 0; at < 256; at += period) {
      for (int band = 0; band < 3; ++band) {
        const int start = at + band * period / 3, width = std::max(2, period / (band == 0 ? 4 : 12));
        const cv::Rect area = pass == 0 ? cv::Rect(start, 0, width, 256) : cv::Rect(0, start, 256, width);
        cv::Mat3b cut = image(area & cv::Rect(0, 0, 256, 256));
        cv::addWeighted(cut, 0.5, cv::Mat3b(cut.size(), cv::Vec3b(bands[band][0], bands[band][1], bands[band][2])), 0.5,
                        0, cut);
      }
    }
  }
  return image;
}

cv::Mat3b stripes(const cv::Scalar& color, Rng& rng) {
  const cv::Scalar other = contrasting(color, rng);
  cv::Mat3b image = plainCloth(color, rng), second = plainCloth(other, rng);
  const int period = 16 << rng.below(3);
  const double share = rng.uniform(0.25, 0.6);
  for (int y = 0; y < 256; ++y) {
    if (y % period < share * period) second.row(y).copyTo(image.row(y));
  }
  return image;
}

cv::Mat3b dots(const cv::Scalar& color, Rng& rng) {
  const cv::Scalar other = contrasting(color, rng);
  cv::Mat3b image = plainCloth(color, rng);
  const int step = 32;
  for (int y = 0; y < 256; y += step) {
    for (int x = 0; x < 256; x += step) {
      cv::circle(image, {x + step / 2 - 4, y + step / 2}, step / 4, other, cv::FILLED, cv::LINE_AA);
    }
  }
  return image;
}

cv::Mat3b printedShirt(const cv::Scalar& color, Rng& rng) {
  cv::Mat3b image;
  cv::resize(plainCloth(color, rng), image, {512, 256}, 0, 0, cv::INTER_LINEAR);
  const cv::Scalar ink = contrasting(color, rng);
  for (const int center : {256, pick(rng, 0, 1) * 512}) {  // the chest, and sometimes the back
    if (rng.below(2) == 0) drawShape(image, {center, 130}, pick(rng, 25, 42), ink, rng);
    for (int line = 0; line < 3; ++line) {
      drawWord(image, randomWord(rng, 3, 6), {center - 50, 90 + 32 * line}, pick(rng, 18, 30),
               line == 1 ? ink : contrasting(color, rng), rng);
    }
  }
  return image;
}

cv::Mat3b skin(const cv::Scalar& color, Rng& rng) {
  return toned(color, fractalNoise({64, 64}, 3, 3, 5, 0.7F, rng), 0.05F, 0.02F, rng);
}

cv::Mat3b face(const cv::Scalar& skin_color, const cv::Scalar& hair_color, Rng& rng) {
  cv::Mat3b image = toned(skin_color, fractalNoise({512, 256}, 4, 4, 6, 0.6F, rng), 0.035F, 0.015F, rng);
  const cv::Scalar shade = darker(skin_color, 0.72),
                   lips(skin_color[0] * 0.6, skin_color[1] * 0.55, skin_color[2] * 0.85);
  const int eye_y = 122, eye_dx = pick(rng, 30, 35);
  for (const int side : {-1, 1}) {
    const cv::Point eye(256 + side * eye_dx, eye_y);
    cv::ellipse(image, eye, {17, 11}, 0, 0, 360, shade, -1, cv::LINE_AA);
    cv::ellipse(image, eye, {13, 6}, 0, 0, 360, {225, 228, 230}, -1, cv::LINE_AA);
    cv::circle(image, eye, 5, {40, 50, 60}, cv::FILLED, cv::LINE_AA);
    cv::ellipse(image, eye + cv::Point(0, -16), {19, 5}, side * 5.0, 180, 360, darker(hair_color, 0.8), 4, cv::LINE_AA);
    cv::ellipse(image, {256 + side * 128, 132}, {14, 24}, 0, 0, 360, darker(skin_color, 0.85), -1, cv::LINE_AA);  // ear
    cv::ellipse(image, {256 + side * 38, 160}, {16, 11}, 0, 0, 360,
                cv::Scalar(skin_color[0] * 0.88, skin_color[1] * 0.9, std::min(255.0, skin_color[2] * 1.02)), -1,
                cv::LINE_AA);  // cheek
  }
  cv::ellipse(image, {256, 152}, {8, 13}, 0, 0, 360, darker(skin_color, 1.06), -1, cv::LINE_AA);
  cv::ellipse(image, {256, 160}, {12, 5}, 0, 0, 180, shade, 3, cv::LINE_AA);
  cv::ellipse(image, {256, 184}, {pick(rng, 17, 23), pick(rng, 5, 8)}, 0, 0, 360, lips, -1, cv::LINE_AA);
  cv::line(image, {238, 184}, {274, 184}, darker(lips, 0.6), 2, cv::LINE_AA);
  if (rng.below(4) == 0) {  // beard
    cv::ellipse(image, {256, 196}, {66, 42}, 0, 0, 180, darker(hair_color, 0.9), 22, cv::LINE_AA);
    cv::ellipse(image, {256, 174}, {30, 5}, 0, 0, 360, darker(hair_color, 0.9), -1, cv::LINE_AA);
  }
  if (rng.below(4) == 0) {  // glasses
    for (const int side : {-1, 1}) {
      cv::ellipse(image, {256 + side * eye_dx, eye_y}, {24, 18}, 0, 0, 360, kInk, 4, cv::LINE_AA);
      cv::line(image, {256 + side * (eye_dx + 24), eye_y}, {256 + side * 128, eye_y - 4}, kInk, 4, cv::LINE_AA);
    }
    cv::line(image, {250, eye_y}, {262, eye_y}, kInk, 4, cv::LINE_AA);
  }
  cv::GaussianBlur(image, image, {}, 1.0);
  return image;
}

cv::Mat3b hair(const cv::Scalar& color, Rng& rng) {
  return toned(color, fractalNoise({256, 128}, 32, 2, 4, 0.85F, rng), 0.22F, 0.08F, rng);
}

cv::Mat3b poster(const cv::Size& size, Rng& rng) {
  const cv::Scalar ground = rng.below(3) == 0 ? kWhite : randomColor(rng, 30, 200, 90, 240);
  cv::Mat3b image(size, cv::Vec3b(ground[0], ground[1], ground[2]));
  for (int i = pick(rng, 5, 14); i > 0; --i) {
    drawShape(image, {pick(rng, 0, size.width), pick(rng, 0, size.height)}, pick(rng, size.width / 20, size.width / 5),
              randomColor(rng, 20, 230, 30, 250), rng);
  }
  const cv::Rect panel(size.width / 10, size.height * pick(rng, 4, 6) / 10, size.width * 8 / 10, size.height * 3 / 10);
  cv::rectangle(image, panel, ground, cv::FILLED);
  const cv::Scalar ink = contrasting(ground, rng);
  drawWord(image, randomWord(rng, 4, 8), {size.width / 12, size.height / 6}, size.width * rng.uniform(0.09, 0.14), ink,
           rng);
  drawParagraph(image, panel, size.width / pick(rng, 20, 34), ink, rng);
  cv::rectangle(image, {0, 0}, {size.width - 1, size.height - 1}, darker(ground, 0.6), 6);
  weather(image, 0.05F, rng);
  return image;
}

cv::Mat3b painting(const cv::Size& size, Rng& rng) {
  // A landscape of noise: sky, hills in steps, and brush strokes.
  cv::Mat3b image(size);
  const cv::Mat1f noise = fractalNoise(size, 3, 3, 7, 0.6F, rng);
  const cv::Scalar sky = randomColor(rng, 40, 130, 160, 240), ground = randomColor(rng, 60, 200, 60, 160);
  const double horizon = rng.uniform(0.3, 0.6);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const double height = static_cast<double>(y) / size.height + 0.12 * noise(0, x) - horizon;
      const int hill = static_cast<int>(std::floor(std::max(0.0, height + 0.05 * noise(y, x)) * 6.0));
      const cv::Scalar base = height < 0 ? sky : darker(ground, 0.6 + 0.22 * hill);
      for (int c = 0; c < 3; ++c)
        image(y, x)[c] = cv::saturate_cast<std::uint8_t>(base[c] * (1.0 + 0.12 * noise(y, x)));
    }
  }
  for (int i = 0; i < 220; ++i) {
    const cv::Point at(pick(rng, 0, size.width - 1), pick(rng, 0, size.height - 1));
    const cv::Vec3b tone = image(at);
    const double factor = rng.uniform(0.6, 1.5);
    cv::line(image, at, at + cv::Point(pick(rng, -16, 16), pick(rng, -9, 9)),
             {tone[0] * factor, tone[1] * factor, tone[2] * factor}, pick(rng, 1, 5), cv::LINE_AA);
  }
  cv::rectangle(image, {0, 0}, {size.width - 1, size.height - 1}, {30, 50, 70}, size.width / 12);
  cv::rectangle(image, {size.width / 26, size.width / 26},
                {size.width - 1 - size.width / 26, size.height - 1 - size.width / 26}, {90, 150, 180}, 3);
  return image;
}

cv::Mat3b screen(Rng& rng) {
  const bool dark = rng.below(2) == 0;
  const cv::Scalar desktop = randomColor(rng, 80, 180, 60, 140);
  cv::Mat3b image(256, 512, cv::Vec3b(desktop[0], desktop[1], desktop[2]));
  for (int window = 0; window < 3; ++window) {
    const cv::Rect area(pick(rng, 4, 220), pick(rng, 4, 70), pick(rng, 200, 280), pick(rng, 120, 170));
    const cv::Scalar page = dark ? cv::Scalar(40, 35, 35) : cv::Scalar(240, 240, 240);
    cv::rectangle(image, area, page, cv::FILLED);
    cv::rectangle(image, cv::Rect(area.x, area.y, area.width, 12), randomColor(rng, 60, 180, 80, 190), cv::FILLED);
    for (int y = area.y + 24; y < area.y + area.height - 4; y += 11) {  // code
      int x = area.x + 6 + 10 * pick(rng, 0, 3);
      while (x < area.x + area.width - 60 && rng.below(5) > 0) {
        const std::string word = randomWord(rng, 2, 8);
        const cv::Scalar ink = dark ? randomColor(rng, 40, 160, 170, 250) : randomColor(rng, 60, 220, 20, 120);
        cv::putText(image, word, {x, y}, cv::FONT_HERSHEY_PLAIN, 0.7, ink, 1, cv::LINE_AA);
        x += 8 * static_cast<int>(word.size()) + 6;
      }
    }
    cv::rectangle(image, area, darker(page, 0.5), 1);
  }
  for (int i = 0; i < 12; ++i) {
    cv::rectangle(image, cv::Rect(6 + 22 * i, 240, 14, 12), randomColor(rng, 60, 230, 80, 240), cv::FILLED);
  }
  cv::rectangle(image, {0, 0}, {511, 255}, {25, 25, 25}, 8);  // bezel
  return image;
}

cv::Mat3b keyboardKeys(Rng& rng) {
  const bool dark = rng.below(3) > 0;
  const cv::Scalar base = dark ? cv::Scalar(35, 35, 38) : cv::Scalar(200, 203, 205);
  const cv::Scalar key = dark ? cv::Scalar(62, 62, 66) : cv::Scalar(235, 236, 238);
  const cv::Scalar letter = dark ? cv::Scalar(215, 215, 215) : cv::Scalar(50, 50, 50);
  cv::Mat3b image(256, 512, cv::Vec3b(base[0], base[1], base[2]));
  constexpr int kRows = 6, kHeight = 38;
  for (int row = 0; row < kRows; ++row) {
    int x = 12;
    while (x < 490) {
      const int width = row == 5 && x > 100 && x < 200 ? 150 : pick(rng, 24, 30);
      const cv::Rect cap(x, 14 + row * kHeight, std::min(width, 500 - x), kHeight - 6);
      cv::rectangle(image, cap, key, cv::FILLED);
      cv::rectangle(image, cap, darker(key, 0.7), 1);
      cv::putText(image, randomWord(rng, 1, 1), {cap.x + 5, cap.y + 20}, cv::FONT_HERSHEY_SIMPLEX, 0.5, letter, 1,
                  cv::LINE_AA);
      x += width + 5;
    }
  }
  return image;
}

cv::Mat3b printedPage(Rng& rng) {
  cv::Mat3b image(256, 256, cv::Vec3b(238, 240, 240));
  drawWord(image, randomWord(rng, 4, 9), {20, 36}, 22, kInk, rng);
  drawParagraph(image, {20, 46, 216, pick(rng, 80, 190)}, 9, kInk, rng);
  if (rng.below(2) == 0) drawShape(image, {128, 190}, pick(rng, 20, 40), randomColor(rng, 60, 220, 60, 220), rng);
  weather(image, 0.02F, rng);
  return image;
}

cv::Mat3b bookCover(Rng& rng) {
  const cv::Scalar ground = randomColor(rng, 40, 220, 50, 220);
  cv::Mat3b image(128, 128, cv::Vec3b(ground[0], ground[1], ground[2]));
  const cv::Scalar ink = contrasting(ground, rng);
  drawShape(image, {pick(rng, 30, 98), pick(rng, 60, 100)}, pick(rng, 15, 30), randomColor(rng, 30, 220, 40, 250), rng);
  drawWord(image, randomWord(rng, 3, 6), {10, 30}, 16, ink, rng);
  drawWord(image, randomWord(rng, 3, 7), {10, 50}, 13, ink, rng);
  cv::rectangle(image, {3, 3}, {124, 124}, ink, 1, cv::LINE_AA);
  weather(image, 0.05F, rng);
  return image;
}

cv::Mat3b bookSpine(Rng& rng) {
  const cv::Scalar ground = randomColor(rng, 30, 220, 40, 235);
  cv::Mat3b image(32, 256, cv::Vec3b(ground[0], ground[1], ground[2]));
  const cv::Scalar ink = contrasting(ground, rng);
  cv::rectangle(image, {pick(rng, 6, 14), 0}, {pick(rng, 18, 28), 31}, ink, cv::FILLED);
  cv::rectangle(image, {pick(rng, 226, 236), 0}, {pick(rng, 240, 250), 31}, darker(ground, 0.6), cv::FILLED);
  drawWord(image, randomWord(rng, 5, 10), {40, 24}, pick(rng, 14, 20), ink, rng);
  weather(image, 0.06F, rng);
  return image;
}

cv::Mat3b pageEdges(Rng& rng) {
  return toned({215, 226, 232}, fractalNoise({64, 64}, 1, 32, 2, 0.7F, rng), 0.10F, 0.03F, rng);
}

cv::Mat3b whiteboard(Rng& rng) {
  cv::Mat3b image(256, 512, cv::Vec3b(238, 240, 240));
  for (int i = 0; i < 16; ++i) {
    const cv::Scalar pen = randomColor(rng, 160, 240, 60, 190);
    const cv::Point at(pick(rng, 30, 420), pick(rng, 40, 230));
    switch (rng.below(4)) {
      case 0: cv::rectangle(image, cv::Rect(at.x, at.y - 25, pick(rng, 40, 90), 36), pen, 2, cv::LINE_AA); break;
      case 1:
        cv::arrowedLine(image, at, at + cv::Point(pick(rng, -60, 60), pick(rng, -40, 40)), pen, 2, cv::LINE_AA);
        break;
      case 2: cv::ellipse(image, at, {pick(rng, 20, 45), pick(rng, 12, 24)}, 0, 0, 360, pen, 2, cv::LINE_AA); break;
      default: drawWord(image, randomWord(rng, 4, 9), at, pick(rng, 12, 20), pen, rng);
    }
  }
  weather(image, 0.02F, rng);
  cv::rectangle(image, {0, 0}, {511, 255}, {150, 150, 150}, 10);
  return image;
}

cv::Mat3b windowView(Rng& rng) {
  cv::Mat3b image(512, 512);
  const cv::Mat1f cloud = fractalNoise({512, 512}, 2, 3, 6, 0.55F, rng);
  for (int y = 0; y < 512; ++y) {
    for (int x = 0; x < 512; ++x) {
      const double white = std::clamp(0.5 + 0.35 * cloud(y, x) + y / 1200.0, 0.0, 1.0);
      image(y, x) =
          cv::Vec3b(250, static_cast<std::uint8_t>(205 + 45 * white), static_cast<std::uint8_t>(165 + 85 * white));
    }
  }
  for (int i = 0; i < 6; ++i) {  // houses
    const cv::Rect house(pick(rng, -40, 460), pick(rng, 210, 380), pick(rng, 60, 140), 320);
    const cv::Scalar tone = randomColor(rng, 10, 90, 90, 200);
    cv::rectangle(image, house, tone, cv::FILLED);
    for (int y = house.y + 12; y < 512; y += 30) {
      for (int x = house.x + 10; x < house.x + house.width - 12; x += 24) {
        cv::rectangle(image, cv::Rect(x, y, 11, 16), darker(tone, rng.uniform(0.3, 0.7)), cv::FILLED);
      }
    }
  }
  for (const int at : {10, 256, 501}) {
    cv::line(image, {at, 0}, {at, 511}, {235, 236, 238}, 20);
    cv::line(image, {0, at}, {511, at}, {235, 236, 238}, 20);
  }
  return image;
}

cv::Mat3b door(const cv::Scalar& color, Rng& rng) {
  cv::Mat3b image(512, 256);
  cv::Mat3b grain;
  cv::rotate(toned(color, woodGrain({512, 256}, rng), 0.06F, 0.015F, rng), grain, cv::ROTATE_90_CLOCKWISE);
  grain.copyTo(image);
  for (const auto& panel : {cv::Rect(36, 36, 184, 190), cv::Rect(36, 286, 184, 190)}) {
    cv::rectangle(image, panel, darker(color, 0.6), 5);
    cv::rectangle(image, cv::Rect(panel.x + 6, panel.y + 6, panel.width - 12, panel.height - 12), darker(color, 1.15),
                  2);
  }
  cv::circle(image, {232, 262}, 8, {150, 160, 165}, cv::FILLED, cv::LINE_AA);
  cv::rectangle(image, {0, 0}, {255, 511}, darker(color, 0.75), 12);
  return image;
}

cv::Mat3b carton(Rng& rng) {
  const cv::Scalar color(rng.uniform(85, 110), rng.uniform(130, 155), rng.uniform(165, 200));
  cv::Mat3b image = toned(color, fractalNoise({256, 256}, 3, 24, 5, 0.7F, rng), 0.05F, 0.03F, rng);
  cv::rectangle(image, {0, 112}, {255, 144}, {140, 180, 200}, cv::FILLED);  // tape
  drawWord(image, randomWord(rng, 4, 7), {24, 70}, 34, {50, 60, 80}, rng);
  cv::rectangle(image, {150, 160}, {236, 232}, kWhite, cv::FILLED);
  drawParagraph(image, {154, 164, 80, 64}, 9, kInk, rng);
  for (int i = 0; i < 3; ++i)
    cv::arrowedLine(image, {30 + 34 * i, 232}, {30 + 34 * i, 170}, {50, 60, 80}, 5, cv::LINE_AA);
  weather(image, 0.05F, rng);
  return image;
}

cv::Mat3b bottleLabel(const cv::Scalar& color, Rng& rng) {
  cv::Mat3b image = toned(color, fractalNoise({256, 128}, 4, 2, 4, 0.6F, rng), 0.08F, 0.02F, rng);
  const cv::Scalar label = randomColor(rng, 60, 230, 120, 250);
  cv::rectangle(image, {0, 40}, {255, 100}, label, cv::FILLED);
  for (int i = 0; i < 3; ++i) {
    drawWord(image, randomWord(rng, 3, 5), {10 + 86 * i, 68}, 18, contrasting(label, rng), rng);
    drawWord(image, randomWord(rng, 4, 7), {10 + 86 * i, 88}, 10, contrasting(label, rng), rng);
  }
  return image;
}

cv::Mat3b cupPrint(const cv::Scalar& color, Rng& rng) {
  cv::Mat3b image = toned(color, fractalNoise({128, 64}, 4, 2, 4, 0.6F, rng), 0.04F, 0.02F, rng);
  const cv::Scalar ink = contrasting(color, rng);
  for (int x = 16; x < 128; x += 32) drawShape(image, {x, 32}, pick(rng, 7, 12), ink, rng);
  return image;
}

}  // namespace semantic_vslam::synthetic
