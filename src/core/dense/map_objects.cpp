// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/dense/map_objects.h"

#include <array>
#include <cmath>
#include <map>

#include "semantic_vslam/core/common/config_fields.h"

namespace semantic_vslam {
namespace {

/// A cube of the grid that holds points of one class, with what is summed over them.
struct Cell {
  int points = 0;
  Eigen::Vector3d sum_m = Eigen::Vector3d::Zero();
  Eigen::AlignedBox3d box_m;
  bool taken = false;
};

using CellKey = std::array<int, 4>;  ///< label, x, y, z: ordered, so that the result is
using Cells = std::map<CellKey, Cell>;

Cells fillCells(const std::vector<LabelledPoint>& cloud, double cell_m) {
  Cells cells;
  for (const LabelledPoint& point : cloud) {
    if (point.label == 0) continue;
    const Eigen::Vector3d p = point.position();
    const Eigen::Vector3i index = (p / cell_m).array().floor().cast<int>();
    Cell& cell = cells[{point.label, index.x(), index.y(), index.z()}];
    ++cell.points;
    cell.sum_m += p;
    cell.box_m.extend(p);
  }
  return cells;
}

/// Takes a cell and all that is connected to it. Depth-first, on a stack of its own: objects can be large.
MapObject growObject(Cells& cells, Cells::iterator seed) {
  MapObject object;
  object.label = static_cast<std::uint8_t>(seed->first[0]);
  std::vector<Cells::iterator> open{seed};
  seed->second.taken = true;
  while (!open.empty()) {
    const auto [key, cell] = *open.back();
    open.pop_back();
    object.points += cell.points;
    object.centroid_m += cell.sum_m;
    object.box_m.extend(cell.box_m);
    for (int i = 0; i < 27; ++i) {
      const auto next = cells.find({key[0], key[1] + i % 3 - 1, key[2] + i / 3 % 3 - 1, key[3] + i / 9 - 1});
      if (next == cells.end() || next->second.taken) continue;
      next->second.taken = true;
      open.push_back(next);
    }
  }
  object.centroid_m /= object.points;
  return object;
}

}  // namespace

std::vector<MapObject> findObjects(const std::vector<LabelledPoint>& cloud, const MapObjectsConfig& config) {
  validateConfig(config);
  Cells cells = fillCells(cloud, config.cell_m);
  std::vector<MapObject> objects;
  for (auto cell = cells.begin(); cell != cells.end(); ++cell) {
    if (cell->second.taken) continue;
    MapObject object = growObject(cells, cell);
    if (object.points >= config.min_points) objects.push_back(object);
  }
  return objects;
}

}  // namespace semantic_vslam
