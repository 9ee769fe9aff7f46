// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/dense/keyframe_cloud.h"

#include <array>
#include <cassert>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/dense/label_votes.h"
#include "core/dense/voxel_key.h"
#include "core/labels/dynamic_objects.h"

namespace semantic_vslam {
namespace {

constexpr std::uint8_t kDynamic = 128;  // as MotionResult::dynamic defines it

/// Mean position and colour and the most frequent label of points that share a cube.
class CellMean {
 public:
  void add(const LabelledPoint& point) {
    xyz_m_ += cv::Vec3d(point.xyz_m);
    bgr_ += cv::Vec3d(point.bgr);
    votes_.add(point.label);
    ++count_;
  }

  LabelledPoint mean() const {
    return {cv::Vec3f(xyz_m_ / count_), cv::Vec3b(bgr_ / count_), votes_.winner()};  // colour is rounded by OpenCV
  }

 private:
  cv::Vec3d xyz_m_, bgr_;
  LabelVotes votes_;
  int count_ = 0;
};

/// Extends a mask along the surface it lies on: a torso whose legs were seen to move goes with them. On cells of 4 px:
/// what of someone is in view at the border of the image may be a strip of 16.
void addRestOfBodies(const cv::Mat1f& depth_m, cv::Mat1b& mask) {
  constexpr int kCellPx = 4;
  constexpr int kReachCells = 32;          // a quarter of the view's height
  constexpr float kStep = 0.02F;           // of the depth, from cell to cell: a body is rounder than a desk is flat
  constexpr float kMostFromSeedM = 0.25F;  // a body's depth; what it stands on or leans at goes on beyond
  const cv::Size cells(depth_m.cols / kCellPx, depth_m.rows / kCellPx);
  if (cells.empty() || cv::countNonZero(mask) == 0) return;
  cv::Mat1f z_m(cells, 0.0F), seed_m(cells, 0.0F);
  cv::Mat1b reach(cells, std::uint8_t{0});
  std::vector<cv::Point> open;
  cv::Mat1b inside(cells, std::uint8_t{0});
  for (int row = 0; row < cells.height; ++row) {
    for (int col = 0; col < cells.width; ++col) {
      const cv::Rect area(col * kCellPx, row * kCellPx, kCellPx, kCellPx);
      z_m(row, col) = depth_m(area)(kCellPx / 2, kCellPx / 2);
      if (cv::countNonZero(mask(area)) == area.area()) inside(row, col) = 255;
    }
  }
  // Masks reach over the outline, onto what is behind: only what lies 8 px inside of one is surely of the body.
  constexpr int kOutlineCells = 2;
  cv::erode(inside, inside, cv::Mat(), {-1, -1}, kOutlineCells);
  for (int row = 0; row < cells.height; ++row) {
    for (int col = 0; col < cells.width; ++col) {
      if (inside(row, col) == 0 || z_m(row, col) <= 0.0F) continue;
      seed_m(row, col) = z_m(row, col);
      reach(row, col) = kReachCells;
      open.emplace_back(col, row);
    }
  }
  for (std::size_t next = 0; next < open.size(); ++next) {  // in order of the distance from the mask
    const cv::Point from = open[next];
    if (reach(from) <= 1) continue;
    for (const cv::Point step : {cv::Point(1, 0), cv::Point(-1, 0), cv::Point(0, 1), cv::Point(0, -1)}) {
      const cv::Point to = from + step;
      if (to.x < 0 || to.y < 0 || to.x >= cells.width || to.y >= cells.height || reach(to) > 0) continue;
      const float z = z_m(to);
      if (z <= 0.0F || std::abs(z - z_m(from)) > kStep * z || std::abs(z - seed_m(from)) > kMostFromSeedM) continue;
      reach(to) = static_cast<std::uint8_t>(reach(from) - 1);
      seed_m(to) = seed_m(from);
      open.push_back(to);
      mask(cv::Rect(to.x * kCellPx, to.y * kCellPx, kCellPx, kCellPx)) = 255;
    }
  }
}

}  // namespace

cv::Mat1b someonePixels(cv::Size size, const cv::Mat1b& labels, const cv::Mat1b& dynamic, const LabelSet& label_set) {
  assert(labels.empty() || labels.size() == size);
  assert(dynamic.empty() || dynamic.size() == size);
  cv::Mat1b someone(size, std::uint8_t{0});
  if (!labels.empty()) someone = maskOfPeople(labels, label_set);
  if (!dynamic.empty()) someone |= (dynamic >= kDynamic);
  return someone;
}

cv::Mat1b excludedPixels(const cv::Mat1f& depth_m, const cv::Mat1b& someone, const KeyframeCloudConfig& config) {
  assert(someone.size() == depth_m.size());
  cv::Mat1b excluded = someone.clone();
  addRestOfBodies(depth_m, excluded);
  if (config.dynamic_margin_px > 0) {
    const int side = 2 * config.dynamic_margin_px + 1;  // a square: separable, ten times cheaper than a disc
    cv::dilate(excluded, excluded, cv::getStructuringElement(cv::MORPH_RECT, {side, side}));
  }
  return excluded;
}

cv::Mat1b depthEdges(const cv::Mat1f& depth_m, double focal_px, const KeyframeCloudConfig& config) {
  constexpr float kNone = 1e6F;  // missing depth must not count as the minimum
  cv::Mat1f nearest = depth_m.clone(), farthest;
  nearest.setTo(kNone, depth_m == 0.0F);
  cv::erode(nearest, nearest, cv::Mat());
  cv::dilate(depth_m, farthest, cv::Mat());
  // The window of 3x3 px spans two pixel steps.
  const auto slope = static_cast<float>(2.0 / focal_px * std::tan(config.max_incidence_deg * CV_PI / 180.0));
  const auto noise = static_cast<float>(3.0 * config.depth_noise.surfaces_m);
  cv::Mat1b edges(depth_m.size(), std::uint8_t{0});
  for (int v = 0; v < depth_m.rows; ++v) {
    const float *low = nearest[v], *high = farthest[v];
    std::uint8_t* edge = edges[v];
    for (int u = 0; u < depth_m.cols; ++u) {
      const float limit_m = low[u] * (slope + noise * low[u]);
      edge[u] = high[u] - low[u] > limit_m ? 255 : 0;
    }
  }
  return edges;
}

KeyframeCloud makeKeyframeCloud(KeyframeId id, const RgbdFrame& frame, const cv::Mat1b& labels,
                                const cv::Mat1b& excluded, const KeyframeCloudConfig& config) {
  assert(labels.empty() || labels.size() == frame.depth_m.size());
  assert(excluded.empty() || excluded.size() == frame.depth_m.size());
  const cv::Mat1b edges = depthEdges(frame.depth_m, frame.camera->fx(), config);
  const auto min_m = static_cast<float>(config.min_depth_m), max_m = static_cast<float>(config.max_depth_m);
  KeyframeCloud cloud{id, frame.stamp, {}};
  for (int v = 0; v < frame.depth_m.rows; v += config.stride_px) {
    for (int u = 0; u < frame.depth_m.cols; u += config.stride_px) {
      const float z_m = frame.depth_m(v, u);
      if (!(z_m >= min_m && z_m <= max_m) || edges(v, u) != 0) continue;
      if (!excluded.empty() && excluded(v, u) != 0) continue;
      const cv::Vec2f& ray = frame.camera->rays()(v, u);
      const std::uint8_t label = labels.empty() ? std::uint8_t{0} : labels(v, u);
      cloud.points.push_back({{ray[0] * z_m, ray[1] * z_m, z_m}, frame.bgr(v, u), label});
    }
  }
  return cloud;
}

std::vector<LabelledPoint> voxelFilter(const std::vector<LabelledPoint>& points, double cell_m) {
  const std::vector<KeyedPoint> keyed = sortByVoxel(points, SE3::Identity(), cell_m);
  std::vector<LabelledPoint> filtered;
  CellMean cell;
  for (std::size_t i = 0; i < keyed.size(); ++i) {
    cell.add(points[keyed[i].index]);
    if (i + 1 == keyed.size() || keyed[i + 1].key != keyed[i].key) {
      filtered.push_back(cell.mean());
      cell = CellMean();
    }
  }
  filtered.shrink_to_fit();  // keyframes keep it for long
  return filtered;
}

}  // namespace semantic_vslam
