// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "core/common/rng.h"

/// Painted textures. All are 8-bit BGR with power-of-two sides, and the same generator state gives the same picture.
namespace semantic_vslam::synthetic {

/// Sum of octaves of smooth noise that repeats at the borders; zero mean, standard deviation 1.
/// @param cells_x, cells_y  noise cells of the coarsest octave  @param gain  amplitude of an octave against the last
cv::Mat1f fractalNoise(const cv::Size& size, int cells_x, int cells_y, int octaves, float gain, Rng& rng);

// Surfaces that repeat.
cv::Mat3b paintedWall(const cv::Scalar& color, Rng& rng);
cv::Mat3b brickWall(const cv::Scalar& color, Rng& rng);
cv::Mat3b wallpaper(const cv::Scalar& color, Rng& rng);
cv::Mat3b woodFloor(const cv::Scalar& color, Rng& rng);
cv::Mat3b carpet(const cv::Scalar& color, Rng& rng);
cv::Mat3b floorTiles(const cv::Scalar& color, Rng& rng);
cv::Mat3b ceilingPanels(Rng& rng);
cv::Mat3b wood(const cv::Scalar& color, Rng& rng);
cv::Mat3b plastic(const cv::Scalar& color, Rng& rng);
cv::Mat3b leaf(Rng& rng);
cv::Mat3b soil(Rng& rng);

// Clothing and people.
cv::Mat3b plainCloth(const cv::Scalar& color, Rng& rng);
cv::Mat3b denim(const cv::Scalar& color, Rng& rng);
cv::Mat3b plaid(const cv::Scalar& color, Rng& rng);
cv::Mat3b stripes(const cv::Scalar& color, Rng& rng);
cv::Mat3b dots(const cv::Scalar& color, Rng& rng);
/// A print on the chest: wraps once round the body, its middle is the front.
cv::Mat3b printedShirt(const cv::Scalar& color, Rng& rng);
cv::Mat3b skin(const cv::Scalar& color, Rng& rng);
/// Wraps once round the head, its middle is the front.
cv::Mat3b face(const cv::Scalar& skin_color, const cv::Scalar& hair_color, Rng& rng);
cv::Mat3b hair(const cv::Scalar& color, Rng& rng);

// Pictures that are stretched over one face.
cv::Mat3b poster(const cv::Size& size, Rng& rng);
cv::Mat3b painting(const cv::Size& size, Rng& rng);
cv::Mat3b screen(Rng& rng);
cv::Mat3b keyboardKeys(Rng& rng);
cv::Mat3b printedPage(Rng& rng);
cv::Mat3b bookCover(Rng& rng);
cv::Mat3b bookSpine(Rng& rng);
cv::Mat3b pageEdges(Rng& rng);
cv::Mat3b whiteboard(Rng& rng);
cv::Mat3b windowView(Rng& rng);
cv::Mat3b door(const cv::Scalar& color, Rng& rng);
cv::Mat3b carton(Rng& rng);
cv::Mat3b bottleLabel(const cv::Scalar& color, Rng& rng);
cv::Mat3b cupPrint(const cv::Scalar& color, Rng& rng);

/// A colour of the given HSV range (hue 0..180 as OpenCV has it, saturation and value 0..255), as BGR.
cv::Scalar randomColor(Rng& rng, double saturation_low, double saturation_high, double value_low, double value_high);

/// One of the given colours, a little lighter or darker and shifted in hue.
cv::Scalar colorFrom(const std::vector<cv::Scalar>& palette, Rng& rng);

}  // namespace semantic_vslam::synthetic
