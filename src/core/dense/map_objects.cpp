// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/dense/map_objects.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <unordered_map>
#include <utility>

#include "semantic_vslam/core/common/config_fields.h"

namespace semantic_vslam {
namespace {

/// Label, x, y and z, 16 bits each: ordered, so that the result is.
using CellKey = std::uint64_t;
constexpr int kCellRange = 1 << 15;  // on each side of the origin: 1966 m at 6 cm

CellKey cellKey(std::uint8_t label, const Eigen::Vector3i& index) {
  CellKey key = label;
  for (int axis = 0; axis < 3; ++axis) key = key << 16 | static_cast<CellKey>(index[axis] + kCellRange);
  return key;
}

/// The labelled points of a cloud in cubes.
struct Cells {
  struct Cell {
    CellKey key;
    std::size_t begin, end;  ///< in points
    bool taken = false;
  };
  std::vector<const LabelledPoint*> points;  ///< those of a cube together
  std::vector<Cell> cells;                   ///< in order of their keys
  std::unordered_map<CellKey, std::size_t> place;

  Cells(const std::vector<LabelledPoint>& cloud, double cell_m) {
    std::vector<std::pair<CellKey, const LabelledPoint*>> keyed;
    for (const LabelledPoint& point : cloud) {
      if (point.label == 0) continue;
      const Eigen::Vector3i index = (point.position() / cell_m).array().floor().cast<int>();
      // At the rim a neighbour's key must stay its own.
      if (index.minCoeff() <= -kCellRange || index.maxCoeff() >= kCellRange - 1) continue;
      keyed.emplace_back(cellKey(point.label, index), &point);
    }
    std::stable_sort(keyed.begin(), keyed.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (std::size_t i = 0; i < keyed.size(); ++i) {
      if (i == 0 || keyed[i].first != keyed[i - 1].first) {
        place.emplace(keyed[i].first, cells.size());
        cells.push_back({keyed[i].first, i, i});
      }
      ++cells.back().end;
      points.push_back(keyed[i].second);
    }
  }
};

/// A connected piece of one class.
struct Piece {
  std::vector<const LabelledPoint*> points;
  Eigen::AlignedBox3d box_m;
  bool flat = false;  ///< a table top or a keyboard: half of it lies within 5 cm of its top

  std::uint8_t label() const { return points.front()->label; }
  void describe() {
    box_m = {};
    for (const LabelledPoint* point : points) box_m.extend(point->position());
    const auto high = std::count_if(points.begin(), points.end(),
                                    [&](const auto* p) { return p->position().z() > box_m.max().z() - 0.05; });
    flat = 2 * static_cast<std::size_t>(high) >= points.size();
  }
};

/// Takes a cell and all that is connected to it. Depth-first, on a stack of its own: objects can be large.
Piece growPiece(Cells& cells, std::size_t seed) {
  Piece piece;
  std::vector<std::size_t> open{seed};
  cells.cells[seed].taken = true;
  while (!open.empty()) {
    const Cells::Cell& cell = cells.cells[open.back()];
    open.pop_back();
    for (std::size_t i = cell.begin; i < cell.end; ++i) piece.points.push_back(cells.points[i]);
    for (int i = 0; i < 27; ++i) {
      const std::int64_t step =
          (std::int64_t{i % 3 - 1} * (std::int64_t{1} << 32)) + (std::int64_t{i / 3 % 3 - 1} * (1 << 16)) + i / 9 - 1;
      const auto next = cells.place.find(cell.key + static_cast<CellKey>(step));
      if (next == cells.place.end() || cells.cells[next->second].taken) continue;
      cells.cells[next->second].taken = true;
      open.push_back(next->second);
    }
  }
  piece.describe();
  return piece;
}

/// Middle, axes and size of the smallest rectangle round the points as seen from above.
cv::RotatedRect footprintOf(const std::vector<const LabelledPoint*>& points) {
  std::vector<cv::Point2f> from_above;
  from_above.reserve(points.size());
  for (const LabelledPoint* point : points) from_above.emplace_back(point->xyz_m[0], point->xyz_m[1]);
  return cv::minAreaRect(from_above);
}

/// Divides what stands like a screen where it hardly goes on along its length: two screens side by side.
std::vector<Piece> divideScreens(Piece piece) {
  constexpr double kThickest = 0.5;  // of its length
  constexpr double kBinM = 0.02;
  constexpr double kHardly = 0.25;  // of the points that a bin has in the middle
  constexpr int kLeastBins = 8;     // on each side: narrower is no screen of its own
  const cv::RotatedRect foot = footprintOf(piece.points);
  const double length_m = std::max(foot.size.width, foot.size.height);
  const double thick_m = std::min(foot.size.width, foot.size.height);
  const int bins = static_cast<int>(length_m / kBinM) + 1;
  std::vector<Piece> screens;
  if (piece.flat || thick_m > kThickest * length_m || bins < 2 * kLeastBins) {
    screens.push_back(std::move(piece));
    return screens;
  }
  const double turn = (foot.angle + (foot.size.width < foot.size.height ? 90.0 : 0.0)) * CV_PI / 180.0;
  const auto binOf = [&](const LabelledPoint* p) {
    const double along_m =
        (p->xyz_m[0] - foot.center.x) * std::cos(turn) + (p->xyz_m[1] - foot.center.y) * std::sin(turn);
    return std::clamp(static_cast<int>((along_m + 0.5 * length_m) / kBinM), 0, bins - 1);
  };
  std::vector<int> count(static_cast<std::size_t>(bins), 0);
  for (const LabelledPoint* point : piece.points) ++count[binOf(point)];
  std::vector<int> sorted = count;
  std::nth_element(sorted.begin(), sorted.begin() + bins / 2, sorted.end());
  const double few = kHardly * sorted[bins / 2];
  std::vector<int> screen_of(count.size(), 0);  // the bins of a gap go to the screen before it
  int screen = 0, begin = 0;
  for (int bin = 0; bin < bins; ++bin) {
    const bool gap_ends = bin > 0 && count[bin - 1] < few && count[bin] >= few;
    if (gap_ends && bin - begin >= kLeastBins && bins - bin >= kLeastBins) {
      ++screen;
      begin = bin;
    }
    screen_of[bin] = screen;
  }
  screens.resize(screen + 1);
  for (const LabelledPoint* point : piece.points) screens[screen_of[binOf(point)]].points.push_back(point);
  for (Piece& part : screens) part.describe();
  return screens;
}

/// Whether two pieces of a class are of one thing: what hides parts of a thing leaves its pieces near each other.
bool sameThing(const Piece& a, const Piece& b) {
  constexpr double kBesideM = 0.10;   // a cable, a book
  constexpr double kAboveM = 0.40;    // the stem of a chair, between its seat and its foot
  constexpr double kStacked = 0.5;    // share of the smaller footprint that lies over the larger
  constexpr double kFragment = 0.25;  // of the larger one's points
  constexpr double kSameTopM = 0.05;
  const Eigen::AlignedBox3d &box_a = a.box_m, &box_b = b.box_m;
  if (a.label() != b.label()) return false;
  const Eigen::Vector3d gap_m = box_a.min().cwiseMax(box_b.min()) - box_a.max().cwiseMin(box_b.max());
  if (gap_m.head<2>().maxCoeff() > kBesideM || gap_m.z() > kAboveM) return false;
  const auto footprint = [](const Eigen::AlignedBox3d& box) { return box.sizes().x() * box.sizes().y(); };
  const double common = std::max(-gap_m.x(), 0.0) * std::max(-gap_m.y(), 0.0);
  if (common >= kStacked * std::min(footprint(box_a), footprint(box_b))) return true;
  const auto [fewer, more] = std::minmax(a.points.size(), b.points.size());
  if (static_cast<double>(fewer) < kFragment * static_cast<double>(more) && gap_m.z() <= kBesideM) return true;
  return a.flat && b.flat && std::abs(box_a.max().z() - box_b.max().z()) < kSameTopM;
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
    pieces[i].points.insert(pieces[i].points.end(), pieces[j].points.begin(), pieces[j].points.end());
    pieces[i].describe();
    pieces.erase(pieces.begin() + static_cast<std::ptrdiff_t>(j));
    i = 0;  // what has grown may reach another
  }
}

MapObject objectOf(const Piece& piece, const EvidenceAt& evidence_at) {
  constexpr double kEvenM = 0.02;  // one point a cube: the near side of a thing has more of them
  MapObject object;
  object.label = piece.label();
  object.points = static_cast<int>(piece.points.size());
  object.box_m = piece.box_m;
  std::vector<LabelledPoint> points;
  for (const LabelledPoint* point : piece.points) points.push_back(*point);
  const std::vector<LabelledPoint> surface = voxelFilter(points, kEvenM);
  for (const LabelledPoint& point : surface) {
    object.centroid_m += point.position() / static_cast<double>(surface.size());
    if (!evidence_at) continue;
    const SurfaceEvidence evidence = evidence_at(point.position());
    object.confidence += evidence.label_share / static_cast<double>(surface.size());
    object.last_seen = std::max(object.last_seen, evidence.last_seen);
  }
  const cv::RotatedRect foot = footprintOf(piece.points);
  object.middle_m = {foot.center.x, foot.center.y, piece.box_m.center().z()};
  object.size_m = {foot.size.width, foot.size.height, piece.box_m.sizes().z()};
  object.yaw_rad = foot.angle * CV_PI / 180.0;
  return object;
}

}  // namespace

std::vector<MapObject> findObjects(const std::vector<LabelledPoint>& cloud, const MapObjectsConfig& config,
                                   const EvidenceAt& evidence_at) {
  validateConfig(config);
  Cells cells(cloud, config.cell_m);
  std::vector<Piece> pieces;
  for (std::size_t cell = 0; cell < cells.cells.size(); ++cell) {
    if (cells.cells[cell].taken) continue;
    Piece piece = growPiece(cells, cell);
    constexpr std::size_t kLeastShare = 10;  // of an object's points: less is noise
    if (kLeastShare * piece.points.size() >= static_cast<std::size_t>(config.min_points)) {
      pieces.push_back(std::move(piece));
    }
  }
  joinPieces(pieces);
  std::vector<MapObject> objects;
  for (Piece& joined : pieces) {
    for (const Piece& piece : divideScreens(std::move(joined))) {
      if (piece.points.size() >= static_cast<std::size_t>(config.min_points)) {
        objects.push_back(objectOf(piece, evidence_at));
      }
    }
  }
  return objects;
}

void ObjectList::giveIds(std::vector<MapObject>& objects, const std::function<SE3(const MapObject&)>& T_now_before) {
  constexpr double kNearM = 0.3, kShareOfSize = 0.5;
  struct Pair {
    double distance_m;
    std::size_t known, object;
  };
  std::vector<Pair> pairs;
  for (std::size_t k = 0; k < known_.size(); ++k) {
    known_[k].centroid_m = T_now_before(known_[k]) * known_[k].centroid_m;
    for (std::size_t i = 0; i < objects.size(); ++i) {
      if (objects[i].label != known_[k].label) continue;
      const double distance_m = (objects[i].centroid_m - known_[k].centroid_m).norm();
      const double reach_m = std::max(kNearM, kShareOfSize * known_[k].size_m.head<2>().minCoeff());
      if (distance_m < reach_m) pairs.push_back({distance_m, k, i});
    }
  }
  // The nearest first; of a thing that fell in two both are as near, and the older id goes on.
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const Pair& a, const Pair& b) { return a.distance_m < b.distance_m; });
  std::vector<bool> gone(known_.size(), true);
  for (const Pair& pair : pairs) {
    if (!gone[pair.known] || objects[pair.object].id != 0) continue;
    gone[pair.known] = false;
    objects[pair.object].id = known_[pair.known].id;
  }
  std::vector<MapObject> now;
  for (std::size_t k = 0; k < known_.size(); ++k) {
    if (gone[k]) now.push_back(known_[k]);
  }
  for (MapObject& object : objects) {
    if (object.id == 0) object.id = next_id_++;
    now.push_back(object);
  }
  if (now.size() > kMost) now.erase(now.begin(), now.end() - kMost);
  known_ = std::move(now);
}

}  // namespace semantic_vslam
