// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/people/mover_detection.h"

#include <algorithm>
#include <cmath>

namespace semantic_vslam {
namespace {

constexpr int kColumns = 160;
constexpr double kCellM = 0.1;          // of the plan view
constexpr double kSigmaM = 0.05;        // of a whole body's axis: limbs swing
constexpr double kCutSigmaM = 0.2;      // of one that the image's border cuts
constexpr double kCutShare = 0.1;       // of its points at the border
constexpr double kOutlierShare = 0.02;  // of heights, at each end: mixed pixels at edges of depth
constexpr double kReachShare = 1.5;     // of the radius: an arm that points
constexpr double kLowM = 0.6;           // a thing lower than this is taken to be as deep as it is wide

/// Dynamic surface as seen from above, on a grid.
class PlanView {
 public:
  PlanView(const DynamicPoints& dynamic, double radius_m)
      : radius_m_(radius_m), reach_(static_cast<int>(std::ceil(radius_m / kCellM))) {
    Eigen::Vector2i low = Eigen::Vector2i::Zero(), high = low;
    for (std::size_t i = 0; i < dynamic.points.size(); ++i) {
      const Eigen::Vector2i cell = cellOf(dynamic.points[i].head<2>().cast<double>());
      low = i == 0 ? cell : low.cwiseMin(cell).eval();
      high = i == 0 ? cell : high.cwiseMax(cell).eval();
    }
    origin_ = low;
    size_ = high - low + Eigen::Vector2i::Ones();
    cells_.resize(dynamic.points.empty() ? 0 : static_cast<std::size_t>(size_.x()) * size_.y());
    for (std::size_t i = 0; i < dynamic.points.size(); ++i) {
      const Eigen::Vector2d p = dynamic.points[i].head<2>().cast<double>();
      Cell& cell = at(cellOf(p) - origin_);
      cell.area += dynamic.area_m2[i];
      cell.sum += dynamic.area_m2[i] * p;
      cell.points.push_back(static_cast<int>(i));
    }
  }

  /// Points of each mover: those nearest to one of the places about which more surface stands than about any other
  /// within a radius.
  /// @param expected  where movers are expected that are not in each other's way: places too, where there is surface
  std::vector<std::vector<int>> groups(const std::vector<Eigen::Vector2d>& expected) {
    for (int y = 0; y < size_.y() && !cells_.empty(); ++y) {
      for (int x = 0; x < size_.x(); ++x) {
        if (at({x, y}).area > 0.0) weigh({x, y});
      }
    }
    // Two who come together have one top, but are two as long as each is known.
    std::vector<Eigen::Vector2d> tops = expected;
    for (int y = 0; y < size_.y() && !cells_.empty(); ++y) {
      for (int x = 0; x < size_.x(); ++x) {
        if (at({x, y}).area == 0.0 || !isTop({x, y})) continue;
        const Eigen::Vector2d& top = at({x, y}).centre;
        const bool known = std::any_of(expected.begin(), expected.end(),
                                       [&](const auto& place) { return (place - top).norm() < radius_m_; });
        if (!known) tops.push_back(top);
      }
    }
    std::vector<std::vector<int>> groups(tops.size());
    for (const Cell& cell : cells_) {
      if (cell.area == 0.0 || tops.empty()) continue;
      const Eigen::Vector2d p = cell.sum / cell.area;
      const auto nearest = std::min_element(tops.begin(), tops.end(), [&](const auto& a, const auto& b) {
        return (a - p).squaredNorm() < (b - p).squaredNorm();
      });
      if ((*nearest - p).norm() > kReachShare * radius_m_) continue;
      auto& group = groups[nearest - tops.begin()];
      group.insert(group.end(), cell.points.begin(), cell.points.end());
    }
    return groups;
  }

 private:
  struct Cell {
    double area = 0.0;                              // m2
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();  // of positions, by area
    std::vector<int> points;
    double weight = 0.0;                               // of the surface around, the nearer the more
    Eigen::Vector2d centre = Eigen::Vector2d::Zero();  // of that surface
  };

  static Eigen::Vector2i cellOf(const Eigen::Vector2d& p) { return (p / kCellM).array().floor().cast<int>(); }
  Cell& at(const Eigen::Vector2i& place) { return cells_[static_cast<std::size_t>(place.y()) * size_.x() + place.x()]; }

  template <class Use>
  void forEachAround(const Eigen::Vector2i& place, const Use& use) {
    for (int y = std::max(0, place.y() - reach_); y <= std::min(size_.y() - 1, place.y() + reach_); ++y) {
      for (int x = std::max(0, place.x() - reach_); x <= std::min(size_.x() - 1, place.x() + reach_); ++x) {
        if (at({x, y}).area > 0.0) use(Eigen::Vector2i(x, y), at({x, y}));
      }
    }
  }

  /// Epanechnikov's kernel.
  void weigh(const Eigen::Vector2i& place) {
    Cell& middle = at(place);
    const Eigen::Vector2d p = middle.sum / middle.area;
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    forEachAround(place, [&](const Eigen::Vector2i&, const Cell& cell) {
      const double share = (cell.sum / cell.area - p).squaredNorm() / (radius_m_ * radius_m_);
      if (share >= 1.0) return;
      middle.weight += (1.0 - share) * cell.area;
      sum += (1.0 - share) * cell.sum;
    });
    middle.centre = sum / middle.weight;
  }

  bool isTop(const Eigen::Vector2i& place) {
    const double weight = at(place).weight;
    bool top = true;
    forEachAround(place, [&](const Eigen::Vector2i& other, const Cell& cell) {
      const bool before = other.y() < place.y() || (other.y() == place.y() && other.x() < place.x());
      if (cell.weight > weight || (cell.weight == weight && before)) top = false;  // of equal ones the first
    });
    return top;
  }

  const double radius_m_;
  const int reach_;
  Eigen::Vector2i origin_ = Eigen::Vector2i::Zero(), size_ = Eigen::Vector2i::Zero();
  std::vector<Cell> cells_;
};

/// @param share  0..1  @return the value below which this share of them lies; reorders them
double quantile(std::vector<double>& values, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

MoverView describe(const DynamicPoints& dynamic, const std::vector<int>& members, const Eigen::Vector2d& camera,
                   const PeopleConfig& config) {
  MoverView view;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  std::size_t cut = 0;
  std::vector<double> heights;
  for (const int i : members) {
    const double area = dynamic.area_m2[i];
    view.area_m2 += area;
    view.person_share += dynamic.person[i] * area;
    mean += area * dynamic.points[i].head<2>().cast<double>();
    heights.push_back(dynamic.points[i].z());
    cut += dynamic.at_edge[i];
  }
  mean /= view.area_m2;
  view.person_share /= view.area_m2;
  view.bottom_m = quantile(heights, kOutlierShare);
  view.top_m = quantile(heights, 1.0 - kOutlierShare);

  const Eigen::Vector2d sight = (mean - camera).normalized(), across(-sight.y(), sight.x());
  std::vector<double> sideways;
  for (const int i : members) sideways.push_back(across.dot(dynamic.points[i].head<2>().cast<double>() - mean));
  view.width_m = quantile(sideways, 0.98) - quantile(sideways, 0.02);
  const bool low = view.top_m - view.bottom_m < kLowM;
  view.position = mean + sight * (low ? std::min(config.half_depth_m, view.width_m / 2) : config.half_depth_m);
  view.sigma_m = static_cast<double>(cut) > kCutShare * static_cast<double>(members.size()) ? kCutSigmaM : kSigmaM;
  return view;
}

}  // namespace

bool MoverView::isLikePerson() const {
  constexpr double kTallM = 0.9, kNarrowM = 0.2, kWideM = 1.1;
  return person_share > 0.5 || (top_m - bottom_m > kTallM && width_m > kNarrowM && width_m < kWideM);
}

DynamicPoints dynamicPoints(const RgbdFrame& frame, const cv::Mat1b& dynamic, const cv::Mat1b& people,
                            const SE3& T_map_camera, const PeopleConfig& config) {
  DynamicPoints result;
  if (dynamic.empty()) return result;
  const int step = std::max(1, frame.depth_m.cols / kColumns);
  const double f = frame.camera->fx() * frame.camera->fy();
  const Eigen::Matrix3f R = T_map_camera.linear().cast<float>();
  const Eigen::Vector3f t = T_map_camera.translation().cast<float>();
  const cv::Mat2f& rays = frame.camera->rays();
  for (int y = step / 2; y < frame.depth_m.rows; y += step) {
    for (int x = step / 2; x < frame.depth_m.cols; x += step) {
      if (dynamic(y, x) < 128) continue;
      const float z = frame.depth_m(y, x);
      if (z <= 0.0F || z > config.max_depth_m) continue;
      const cv::Vec2f& ray = rays(y, x);
      result.points.emplace_back(R * Eigen::Vector3f(ray[0] * z, ray[1] * z, z) + t);
      result.area_m2.push_back(static_cast<float>(z * z * step * step / f));
      result.person.push_back(!people.empty() && people(y, x) > 0 ? 1 : 0);
      const bool edge =
          x < 2 * step || y < 2 * step || x >= frame.depth_m.cols - 2 * step;  // the feet always leave below
      result.at_edge.push_back(edge ? 1 : 0);
    }
  }
  return result;
}

std::vector<MoverView> findMovers(const DynamicPoints& dynamic, const Eigen::Vector2d& camera,
                                  const std::vector<Eigen::Vector2d>& expected, const PeopleConfig& config) {
  // Seen are surfaces, in front of the axes.
  std::vector<Eigen::Vector2d> surfaces;
  for (const auto& axis : expected) surfaces.push_back(axis - (axis - camera).normalized() * config.half_depth_m);
  std::vector<MoverView> movers;
  for (const std::vector<int>& group : PlanView(dynamic, config.radius_m).groups(surfaces)) {
    double area_m2 = 0.0;
    for (const int i : group) area_m2 += dynamic.area_m2[i];
    if (area_m2 >= config.min_area_m2) movers.push_back(describe(dynamic, group, camera, config));
  }
  return movers;
}

}  // namespace semantic_vslam
