// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "eval/synthetic/patterns.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "eval/synthetic/pattern_tools.h"

namespace semantic_vslam::synthetic {

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

}  // namespace semantic_vslam::synthetic
