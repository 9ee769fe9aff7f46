// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/features/frame_features.h"

#include <array>
#include <cmath>
#include <cstring>

namespace semantic_vslam {

double pyramidScale(int octave) {
  static const auto scales = [] {
    std::array<double, kPyramidLevels> table{};
    for (int i = 0; i < kPyramidLevels; ++i) table[i] = std::pow(kPyramidScale, i);
    return table;
  }();
  return scales[octave];
}

int descriptorDistance(const std::uint8_t* a, const std::uint8_t* b) {
  int distance = 0;
  for (int i = 0; i < 4; ++i) {
    std::uint64_t x = 0, y = 0;
    std::memcpy(&x, a + 8 * i, 8);
    std::memcpy(&y, b + 8 * i, 8);
    distance += __builtin_popcountll(x ^ y);
  }
  return distance;
}

}  // namespace semantic_vslam
