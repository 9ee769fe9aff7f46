// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <opencv2/core.hpp>
#include <string>

#include "core/common/rng.h"

/// What painted textures are made of.
namespace semantic_vslam::synthetic {

inline const cv::Scalar kWhite(245, 245, 245), kInk(40, 35, 35);

/// A whole number from low to high, both included.
int pick(Rng& rng, int low, int high);

/// One colour times (1 + contrast * pattern), plus fine speckle.
cv::Mat3b toned(const cv::Scalar& color, const cv::Mat1f& pattern, float contrast, float speckle, Rng& rng);

/// Multiplies a picture by (1 + contrast * noise), so that prints look worn and lit rather than drawn.
void weather(cv::Mat3b& image, float contrast, Rng& rng);

/// A word of low to high letters.
std::string randomWord(Rng& rng, int low, int high);

/// The word with its lower left corner at `at`.
void drawWord(cv::Mat3b& image, const std::string& word, cv::Point at, double height_px, const cv::Scalar& color,
              Rng& rng);

/// Lines of words from the left margin to a ragged right one.
void drawParagraph(cv::Mat3b& image, const cv::Rect& area, double height_px, const cv::Scalar& color, Rng& rng);

/// A disc, ring, box or star.
void drawShape(cv::Mat3b& image, const cv::Point& center, int radius, const cv::Scalar& color, Rng& rng);

cv::Scalar darker(const cv::Scalar& color, double factor);

/// A dark colour for a light ground and the other way round.
cv::Scalar contrasting(const cv::Scalar& color, Rng& rng);

/// Draws something that may cross the border at all nine shifts, so that the texture still repeats.
void drawWrapped(cv::Mat3b& image, const std::function<void(cv::Mat3b&, cv::Point)>& draw);

/// Long veins along u that bend a little; about zero mean.
cv::Mat1f woodGrain(const cv::Size& size, Rng& rng);

}  // namespace semantic_vslam::synthetic
