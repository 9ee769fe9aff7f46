// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace semantic_vslam {

/// The image pyramid of ORB (Rublee et al. 2011; Mur-Artal and Tardos 2015): fixed, since landmarks keep their distance
/// range in its terms.
constexpr int kPyramidLevels = 8;
constexpr double kPyramidScale = 1.2;

/// @return kPyramidScale to the power of octave: the size of one pixel of that level, px; also the sigma of a feature.
double pyramidScale(int octave);

/// One ORB feature of a frame.
struct Feature {
  Eigen::Vector2f raw_px;          ///< where the image shows it
  Eigen::Vector2f undistorted_px;  ///< where an ideal pinhole camera would show it
  float depth_m = 0.0F;            ///< z in metres; 0 = none
  float angle_rad = 0.0F;          ///< orientation by the intensity centroid
  int octave = 0;                  ///< pyramid level, 0 = full size
  float static_weight = 1.0F;      ///< 1 = surely static, 0 = surely on a moving object; scales its information

  /// Others make no landmarks and tell no place: a wrong landmark costs more than a missing one.
  bool surelyStatic() const { return static_weight >= 0.5F; }
};

/// Features of one frame with their descriptors; row i of descriptors belongs to features[i].
struct FrameFeatures {
  std::vector<Feature> features;
  cv::Mat1b descriptors;  ///< N x 32 bytes, ORB

  std::size_t size() const { return features.size(); }
};

/// Hamming distance of two 256-bit descriptors. @param a, b 32 bytes each. @return 0..256.
int descriptorDistance(const std::uint8_t* a, const std::uint8_t* b);

}  // namespace semantic_vslam
