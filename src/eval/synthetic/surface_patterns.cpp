// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "eval/synthetic/patterns.h"

#include <opencv2/imgproc.hpp>

#include "eval/synthetic/pattern_tools.h"

namespace semantic_vslam::synthetic {

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

}  // namespace semantic_vslam::synthetic
