// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/dense/grid_file.h"

#include <cstdio>
#include <filesystem>

#include "core/common/atomic_file.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

// map_saver's grey values, and the thresholds that tell them apart again.
constexpr unsigned char kBlack = 0, kGrey = 205, kWhite = 254;
constexpr const char* kThresholds = "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";

char greyOf(std::int8_t cell) {
  if (cell == OccupancyGrid::kUnknown) return static_cast<char>(kGrey);
  return static_cast<char>(cell == OccupancyGrid::kFree ? kWhite : kBlack);
}

}  // namespace

void writeGrid(const OccupancyGrid& grid, const std::string& name) {
  if (grid.cells.empty()) throw Error("the grid has no cells yet; '" + name + ".pgm' is not touched");
  std::string image = "P5\n" + std::to_string(grid.width) + " " + std::to_string(grid.height) + "\n255\n";
  image.reserve(image.size() + grid.cells.size());
  for (int y = grid.height - 1; y >= 0; --y) {
    for (int x = 0; x < grid.width; ++x) image.push_back(greyOf(grid.at(x, y)));
  }
  char place[160];
  std::snprintf(place, sizeof(place), "resolution: %.6g\norigin: [%.6f, %.6f, 0.0]\n", grid.resolution_m,
                grid.origin_x_m, grid.origin_y_m);
  writeTextAtomically(name + ".pgm", image);
  const std::string image_name = std::filesystem::path(name).filename().string() + ".pgm";
  writeTextAtomically(name + ".yaml", "image: " + image_name + "\n" + place + kThresholds);
}

}  // namespace semantic_vslam
