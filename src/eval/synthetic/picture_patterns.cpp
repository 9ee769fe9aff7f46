// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "eval/synthetic/patterns.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>

#include "eval/synthetic/pattern_tools.h"

namespace semantic_vslam::synthetic {

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
