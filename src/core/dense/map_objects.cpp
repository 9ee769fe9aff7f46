// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/dense/map_objects.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

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

/// A connected piece, with the heights of its cells.
struct Piece {
  MapObject object;
  std::vector<double> heights_m;

  double topM() const { return object.box_m.max().z(); }
  /// A table top or a keyboard: half of its cells lie within 5 cm of its top.
  bool flat() const {
    const auto high = std::count_if(heights_m.begin(), heights_m.end(), [&](double z) { return z > topM() - 0.05; });
    return 2 * static_cast<std::size_t>(high) >= heights_m.size();
  }
};

/// Takes a cell and all that is connected to it. Depth-first, on a stack of its own: objects can be large.
Piece growPiece(Cells& cells, Cells::iterator seed) {
  Piece piece;
  MapObject& object = piece.object;
  object.label = static_cast<std::uint8_t>(seed->first[0]);
  std::vector<Cells::iterator> open{seed};
  seed->second.taken = true;
  while (!open.empty()) {
    const auto [key, cell] = *open.back();
    open.pop_back();
    object.points += cell.points;
    object.centroid_m += cell.sum_m;
    object.box_m.extend(cell.box_m);
    piece.heights_m.push_back(cell.box_m.center().z());
    for (int i = 0; i < 27; ++i) {
      const auto next = cells.find({key[0], key[1] + i % 3 - 1, key[2] + i / 3 % 3 - 1, key[3] + i / 9 - 1});
      if (next == cells.end() || next->second.taken) continue;
      next->second.taken = true;
      open.push_back(next);
    }
  }
  object.centroid_m /= object.points;
  return piece;
}

/// Whether two pieces of a class are of one thing: what hides parts of a thing leaves its pieces near each other.
bool sameThing(const Piece& a, const Piece& b) {
  constexpr double kBesideM = 0.10;   // a cable, a book
  constexpr double kAboveM = 0.40;    // the stem of a chair, between its seat and its foot
  constexpr double kStacked = 0.5;    // share of the smaller footprint that lies over the larger
  constexpr double kFragment = 0.25;  // of the larger one's points
  constexpr double kSameTopM = 0.05;
  const Eigen::AlignedBox3d &box_a = a.object.box_m, &box_b = b.object.box_m;
  if (a.object.label != b.object.label) return false;
  const Eigen::Vector3d gap_m = box_a.min().cwiseMax(box_b.min()) - box_a.max().cwiseMin(box_b.max());
  if (gap_m.head<2>().maxCoeff() > kBesideM || gap_m.z() > kAboveM) return false;
  const auto footprint = [](const Eigen::AlignedBox3d& box) { return box.sizes().x() * box.sizes().y(); };
  const double common = std::max(-gap_m.x(), 0.0) * std::max(-gap_m.y(), 0.0);
  if (common >= kStacked * std::min(footprint(box_a), footprint(box_b))) return true;
  const int fewer = std::min(a.object.points, b.object.points), more = std::max(a.object.points, b.object.points);
  if (fewer < kFragment * more && gap_m.z() <= kBesideM) return true;
  return a.flat() && b.flat() && std::abs(a.topM() - b.topM()) < kSameTopM;
}

void absorb(const Piece& other, Piece& piece) {
  MapObject& object = piece.object;
  const int points = object.points + other.object.points;
  object.centroid_m = (object.points * object.centroid_m + other.object.points * other.object.centroid_m) / points;
  object.points = points;
  object.box_m.extend(other.object.box_m);
  piece.heights_m.insert(piece.heights_m.end(), other.heights_m.begin(), other.heights_m.end());
}

/// Joins pieces until none is left that belongs to another.
void joinPieces(std::vector<Piece>& pieces) {
  for (std::size_t i = 0; i < pieces.size();) {
    std::size_t j = i + 1;
    while (j < pieces.size() && !sameThing(pieces[i], pieces[j])) ++j;
    if (j == pieces.size()) {
      ++i;
      continue;
    }
    absorb(pieces[j], pieces[i]);
    pieces.erase(pieces.begin() + static_cast<std::ptrdiff_t>(j));
    i = 0;  // what has grown may reach another
  }
}

}  // namespace

std::vector<MapObject> findObjects(const std::vector<LabelledPoint>& cloud, const MapObjectsConfig& config) {
  validateConfig(config);
  Cells cells = fillCells(cloud, config.cell_m);
  std::vector<Piece> pieces;
  for (auto cell = cells.begin(); cell != cells.end(); ++cell) {
    if (cell->second.taken) continue;
    Piece piece = growPiece(cells, cell);
    constexpr int kLeastShare = 10;  // of an object's points: less is noise
    if (kLeastShare * piece.object.points >= config.min_points) pieces.push_back(std::move(piece));
  }
  joinPieces(pieces);
  std::vector<MapObject> objects;
  for (const Piece& piece : pieces) {
    if (piece.object.points >= config.min_points) objects.push_back(piece.object);
  }
  return objects;
}

}  // namespace semantic_vslam
